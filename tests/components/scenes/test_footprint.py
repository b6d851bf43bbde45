import math

import mujoco
import numpy as np
import pytest
from support.full import full_but

import mimoc
from mimoc.body.poses import POSES
from mimoc.compiler import building, model_check
from mimoc.compiler.building import Builder
from mimoc.compiler.mjcf.scene import Keyframe
from mimoc.compiler.placing import place_pose
from mimoc.compiler.scenes import Placement, footprint, reach_of, reachable_floor


def grown(age_months: float, **body) -> Builder:
    spec = {"mimoc": 1, "name": "x", "age_months": age_months, "body": body, "scene": {"kind": "flat"}}
    return building.builder(mimoc.InfantSpec.model_validate(spec))


@pytest.fixture(scope="module", params=full_but([(0, "mitten")], [(9, "five_finger"), (24, "mitten")]), ids=str)
def infant(request) -> Builder:
    age_months, hands = request.param
    return grown(age_months, hands=hands)


def start(infant: Builder, pose: str) -> Keyframe:
    return next(each for each in infant.infant.keyframes if each.name == pose)


def posed(infant: Builder, keyframe: Keyframe) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = model_check.compile_model(infant(0).files)
    data = mujoco.MjData(model)
    data.qpos[:] = keyframe.qpos
    mujoco.mj_forward(model, data)
    return model, data


def outline(model: mujoco.MjModel, data: mujoco.MjData) -> np.ndarray:
    """Return points all over the surface of an infant's solids, seen from above, shape (n, 2)."""
    rng, points = np.random.default_rng(0), []
    for index in range(model.ngeom):
        if model.geom_bodyid[index] and model.geom_contype[index]:
            size, kind = model.geom_size[index], model.geom_type[index]
            local = rng.normal(size=(200, 3))
            local /= np.linalg.norm(local, axis=1)[:, None]
            if kind == mujoco.mjtGeom.mjGEOM_BOX:
                local = size * local / np.abs(local).max(axis=1)[:, None]
            elif kind == mujoco.mjtGeom.mjGEOM_SPHERE:
                local = size[0] * local
            elif kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
                local = size * local
            else:
                local = size[0] * local + np.outer(np.sign(local[:, 2]), (0, 0, size[1]))
            points.append(data.geom_xpos[index] + local @ data.geom_xmat[index].reshape(3, 3).T)
    return np.concatenate(points)[:, :2]


@pytest.mark.parametrize("pose", POSES)
def test_the_discs_cover_the_infant_seen_from_above(infant, pose):
    """As MuJoCo places it, somewhere in a room; between two discs of a row, a thirtieth of their radius is missing."""
    keyframe = place_pose(start(infant, pose), Placement(0.7, -1.2, 2.0))
    discs = footprint(infant.tree, [keyframe.qpos])
    points = outline(*posed(infant, keyframe))
    outside = np.linalg.norm(points[:, None] - discs[:, :2], axis=2) - discs[:, 2]
    assert outside.min(axis=1).max() < 1.5e-3


@pytest.mark.parametrize("pose", POSES)
def test_the_discs_are_no_larger_than_the_infant(infant, pose):
    keyframe = start(infant, pose)
    discs, points = footprint(infant.tree, [keyframe.qpos]), outline(*posed(infant, keyframe))
    for angle in np.linspace(0, 2 * math.pi, 12, endpoint=False):
        along = np.array([math.cos(angle), math.sin(angle)])
        assert (discs[:, :2] @ along + discs[:, 2]).max() < (points @ along).max() + 0.015


def test_several_poses_take_up_what_each_does(infant):
    states = [each.qpos for each in infant.infant.keyframes]
    together = footprint(infant.tree, states)
    assert np.array_equal(together, np.concatenate([footprint(infant.tree, [state]) for state in states]))


def test_the_reach_of_discs_is_that_of_the_farthest():
    assert reach_of(np.array([[3.0, 4.0, 0.5], [0.0, 0.0, 5.0]])) == 5.5


@pytest.mark.parametrize("pose", POSES)
def test_the_reach_is_centred_between_the_shoulders_and_as_far_as_arms_go(infant, pose):
    reach = reachable_floor(infant.tree, start(infant, pose).qpos)
    _, data = posed(infant, start(infant, pose))
    shoulders = np.array([data.body(f"{side}_upper_arm").xpos for side in ("left", "right")])
    assert reach.centre_m == pytest.approx(shoulders.mean(axis=0)[:2], abs=0.03)
    length_m = infant.manifest.child.length_cm / 100
    assert 0.25 * length_m < reach.radius_m < 0.85 * length_m
    assert 0 < reach.fading_m < reach.radius_m


def test_an_infant_that_leans_over_reaches_farther_than_one_that_lies():
    infant = grown(9)
    lying, sitting = (reachable_floor(infant.tree, start(infant, pose).qpos) for pose in ("supine", "sitting"))
    assert sitting.radius_m > lying.radius_m


def test_reach_moves_and_turns_with_the_infant(infant):
    here = start(infant, "supine")
    there = place_pose(here, Placement(1.0, 2.0, math.pi / 2))
    first, second = (reachable_floor(infant.tree, each.qpos) for each in (here, there))
    x, y = first.centre_m
    assert second.centre_m == pytest.approx((1.0 - y, 2.0 + x))
    assert second.radius_m == pytest.approx(first.radius_m)


def test_one_arm_is_enough_to_reach():
    whole, one = grown(9), grown(9, remove=["left_upper_arm"])
    both_m, one_m = (reachable_floor(each.tree, start(each, "supine").qpos).radius_m for each in (whole, one))
    assert 0 < one_m < both_m


def test_an_infant_without_arms_reaches_nothing():
    infant = grown(9, remove=["left_upper_arm", "right_upper_arm"])
    assert reachable_floor(infant.tree, start(infant, "supine").qpos) is None

from collections.abc import Iterator, Mapping
from functools import cache
from typing import Any

import mujoco
import numpy as np
import pytest
from scipy import stats
from support.full import FULL, full_but

import mimoc
from mimoc.base.errors import NoSpaceError
from mimoc.compiler import building, model_check
from mimoc.compiler.mjcf.scene import SceneTree
from mimoc.compiler.placing import SceneAssets, place_in_scene
from mimoc.compiler.scenes import footprint, reachable_floor
from mimoc.compiler.toys import GAP_M

SIX = {"count": [6, 6]}
INFANTS = {0: "mitten", 9: "five_finger", 24: "mitten"}  # Age in months, and hands.
TOUCH_M = 1.5e-4
"""How deep things may be in each other at the start: as deep as bodies rest on the floor, and a rounding."""


def spec(age_months: float, scene: Mapping[str, Any]) -> mimoc.InfantSpec:
    body = {"hands": INFANTS[int(age_months)]}
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "body": body, "scene": scene}
    return mimoc.InfantSpec.model_validate(data)


@cache
def grown(age_months: int = 9) -> building.Builder:
    return building.builder(spec(age_months, {"kind": "flat"}))


def furnished(seed: int, age_months: int = 9, **scene: Any) -> SceneTree:
    infant = grown(age_months)
    wanted = spec(age_months, {"kind": "room", "toys": SIX, "seed": seed, **scene})
    return place_in_scene(infant.infant, wanted, infant.tree, SceneAssets()).scene


@cache
def usual(count: int = 40) -> list[SceneTree]:
    return [furnished(seed) for seed in range(count)]


@cache
def usual_discs(count: int = 40) -> list[np.ndarray]:
    return [discs(scene) for scene in usual(count)]


def discs(scene: SceneTree) -> np.ndarray:
    """Return what the toys take up of the floor: x, y and radius, shape (n, 3)."""
    return np.array([[*each.pos_m[:2], radius_m(each)] for each in scene.world.objects])


def radius_m(each) -> float:
    looks = [mesh.content.decode() for mesh in each.meshes if mesh.inertia == "shell"]
    rows = [line.split()[1:3] for text in looks for line in text.splitlines() if line.startswith("v ")]
    return float(np.linalg.norm(np.array(rows, float), axis=1).max())


def half_floor_m(scene: SceneTree) -> np.ndarray:
    floor = next(geom for geom in scene.world.furniture.geoms if geom.name == "floor")
    return np.array(floor.size_m[:2])


@pytest.mark.full
@pytest.mark.parametrize("seeds", full_but([40], [120]))
def test_toys_are_in_the_room_and_apart_from_each_other_and_from_the_infant_in_every_pose(seeds):
    for scene, toys in zip(usual(seeds), usual_discs(seeds), strict=True):
        assert (np.abs(toys[:, :2]) + toys[:, 2:] <= half_floor_m(scene) - GAP_M + 1e-5).all()
        gaps = np.linalg.norm(toys[:, None, :2] - toys[:, :2], axis=2) - toys[:, 2] - toys[:, None, 2]
        assert gaps[np.triu_indices(len(toys), 1)].min() > GAP_M - 1e-5
        taken = footprint(grown().tree, [pose.qpos[: -7 * len(toys)] for pose in scene.keyframes])
        gaps = np.linalg.norm(toys[:, None, :2] - taken[:, :2], axis=2) - taken[:, 2] - toys[:, None, 2]
        assert gaps.min() > GAP_M - 1e-5


@pytest.mark.full
def test_every_pose_has_the_toys_at_their_places():
    for scene in usual()[:30]:
        resting = [number for each in scene.world.objects for number in (*each.pos_m, *each.quat)]
        assert [pose.name for pose in scene.keyframes] == ["supine", "prone", "sitting", "standing"]
        for pose in scene.keyframes:
            assert list(pose.qpos[-len(resting) :]) == resting


@FULL
def test_first_toys_are_as_far_as_the_stated_distribution_says():
    """On an endless floor, as far as the infant itself leaves it free: counted by simulation of the same density."""
    infant = grown()
    scenes = [furnished(seed, kind="flat", toys={"count": [1, 1]}) for seed in range(120)]
    here = infant.infant.keyframes[0].qpos
    reach = reachable_floor(infant.tree, here)
    taken = footprint(infant.tree, [pose.qpos for pose in infant.infant.keyframes])
    toys = np.concatenate([discs(scene) for scene in scenes])
    drawn = reach.draw(10_000, np.random.default_rng(0))
    sizes = np.random.default_rng(1).choice(toys[:, 2], len(drawn))
    nearest = (np.linalg.norm(drawn[:, None] - taken[:, :2], axis=2) - taken[:, 2]).min(axis=1)
    free = drawn[nearest >= sizes + GAP_M]
    expected, found = (np.linalg.norm(places - reach.centre_m, axis=1) for places in (free, toys[:, :2]))
    edges = np.quantile(expected, np.linspace(0, 1, 11)[1:-1])
    counts = np.bincount(np.searchsorted(edges, found), minlength=10)
    assert stats.chisquare(counts).pvalue > 0.01


def test_most_toys_are_within_reach():
    """Of the infant as it starts; in a crib, and where the infant itself is in the way, fewer can be."""
    infant, near, total = grown(), 0, 0
    for scene, toys in zip(usual(), usual_discs(), strict=True):
        here = next(pose for pose in scene.keyframes if pose.name == "supine").qpos[: -7 * 6]
        reach = reachable_floor(infant.tree, here)
        away = np.linalg.norm(toys[:, :2] - reach.centre_m, axis=1) - toys[:, 2]
        near, total = near + (away <= reach.radius_m).sum(), total + len(away)
        assert away.min() < reach.radius_m + 10 * reach.fading_m
    assert 0.4 < near / total < 0.95


@pytest.mark.parametrize("seeds", full_but([40], [120]))
def test_the_infant_is_anywhere_in_its_room_turned_in_any_direction(seeds):
    poses = np.array([scene.keyframes[3].qpos[:7] for scene in usual(seeds)])
    yaw = 2 * np.arctan2(poses[:, 6], poses[:, 3]) % (2 * np.pi)
    assert stats.chisquare(np.histogram(yaw, 8, (0, 2 * np.pi))[0]).pvalue > 0.01
    assert (poses[:, :2].std(axis=0) > 0.3).all()


def test_the_same_seed_gives_the_same_scene_and_another_one_another():
    assert furnished(5) == furnished(5) != furnished(6)


@pytest.mark.parametrize("seeds", full_but([5], [20]))
def test_more_toys_leave_the_room_the_infant_and_the_first_toys_alone(seeds):
    for seed in range(seeds):
        few, many = (furnished(seed, toys={"count": [count, count]}) for count in (2, 9))
        assert few.world.furniture == many.world.furniture
        assert few.world.objects == many.world.objects[:2]
        for before, after in zip(few.keyframes, many.keyframes, strict=True):
            assert before.qpos == after.qpos[: len(before.qpos)]


def test_without_toys_there_are_none():
    scene = furnished(0, toys=None)
    assert scene.world.objects == ()
    assert {len(pose.qpos) for pose in scene.keyframes} == {len(grown().infant.keyframes[0].qpos)}


def test_too_many_toys_are_refused():
    with pytest.raises(NoSpaceError, match="not enough space for 50 toys"):
        furnished(0, kind="crib", toys={"count": [50, 50], "size_cm": [20, 30]})


@pytest.mark.parametrize("age_months", INFANTS)
@pytest.mark.parametrize("kind", ["room", "crib", "flat"])
def test_nothing_overlaps_at_the_start_in_any_pose(kind, age_months):
    for seed, model in compiled(kind, age_months, range(4)):
        data = mujoco.MjData(model)
        for pose in range(model.nkey):
            mujoco.mj_resetDataKeyframe(model, data, pose)
            mujoco.mj_forward(model, data)
            for contact in data.contact:
                first, second = (owner(model, geom) for geom in contact.geom)
                between = (
                    seed,
                    model.key(pose).name,
                    model.geom(contact.geom[0]).name,
                    model.geom(contact.geom[1]).name,
                )
                assert "infant" not in (first, second) or {first, second} <= {"infant", "world"}, between
                if first != "infant" or second != "infant":
                    assert contact.dist > -TOUCH_M, between
                    assert on_the_floor(model, contact), between


@pytest.mark.full
@pytest.mark.parametrize("kind", ["room", "crib"])
@pytest.mark.parametrize("age_months", [0, 24])
def test_left_alone_toys_stay_where_they_are_for_five_seconds(kind, age_months):
    for seed, model in compiled(kind, age_months, range(4)):
        bodiless(model)
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        start = data.qpos.copy()
        mujoco.mj_step(model, data, nstep=round(5 / model.opt.timestep))
        for joint in toy_joints(model):
            at, speed = model.jnt_qposadr[joint], model.jnt_dofadr[joint]
            name = f"seed {seed}: {model.joint(joint).name}"
            assert np.linalg.norm(data.qpos[at : at + 3] - start[at : at + 3]) < 0.005, name
            assert np.abs(data.qvel[speed : speed + 6]).max() < 0.01, name


@pytest.mark.full
@pytest.mark.parametrize("kind", ["room", "crib"])
def test_no_toy_falls_through_or_flies_off_while_the_infant_moves(kind):
    for seed, model in compiled(kind, 9, range(2)):
        data, rng = mujoco.MjData(model), np.random.default_rng(seed)
        mujoco.mj_resetDataKeyframe(model, data, model.key("supine").id)
        for _ in range(250):
            data.ctrl[:] = rng.uniform(-1, 1, model.nu)
            mujoco.mj_step(model, data, nstep=4)
            places = np.array([data.qpos[model.jnt_qposadr[joint] :][:3] for joint in toy_joints(model)])
            assert -0.02 < places[:, 2].min() <= places[:, 2].max() < 0.6, seed
            assert np.abs(places[:, :2]).max() < 2.6, seed
        assert not any(warning.number for warning in data.warning)


def compiled(kind: str, age_months: int, seeds: range) -> Iterator[tuple[int, mujoco.MjModel]]:
    toys = {"count": [3, 3]} if kind == "crib" else SIX
    builder = building.builder(spec(age_months, {"kind": kind, "toys": toys}))
    for seed in seeds:
        yield seed, model_check.compile_model(builder(seed, check=False).files)


def owner(model: mujoco.MjModel, geom: int) -> str:
    body = model.body(model.geom_bodyid[geom]).name
    return body if body == "world" or body.startswith("toy") else "infant"


def on_the_floor(model: mujoco.MjModel, contact) -> bool:
    """Return whether a contact is with a plane that faces up."""
    kinds = [model.geom_type[geom] for geom in contact.geom]
    return mujoco.mjtGeom.mjGEOM_PLANE in kinds and abs(contact.pos[2]) < 1e-3


def toy_joints(model: mujoco.MjModel) -> list[int]:
    return [joint for joint in range(model.njnt) if model.joint(joint).name.startswith("toy")]


def bodiless(model: mujoco.MjModel) -> None:
    """Let the infant touch nothing: it falls through the floor."""
    for geom in range(model.ngeom):
        if owner(model, geom) == "infant":
            model.geom_contype[geom] = model.geom_conaffinity[geom] = 0

"""Our own kinematics, used before there is a model, agree with MuJoCo's."""

import math
from itertools import count, pairwise

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_average, grow_tree
from mimoc.body.kinematics import pose, pose_all
from mimoc.body.poses import CONTACT_DEPTH_M, POSES, Pose, pose_angles, poses_of, resting_state, resting_states
from mimoc.fits import measure

TREES = {hands: grow_tree(measure(9), assemble(hands, False)) for hands in ("mitten", "five_finger")}
TREE = TREES["mitten"]
HANDS = st.sampled_from(sorted(TREES))

angles_rad = st.floats(-1.5, 1.5)
directions = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)


@settings(max_examples=40)
@given(hands=HANDS, data=st.data())
def test_parts_are_where_mujoco_has_them(hands, data, infant_at):
    model, tree = infant_at(9, hands).model, TREES[hands]
    values = data.draw(st.lists(angles_rad, min_size=len(tree.joints), max_size=len(tree.joints)))
    data = mujoco.MjData(model)
    data.qpos[:7] = 0, 0, 0, 1, 0, 0, 0
    data.qpos[7:] = values
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    posed = pose(tree, dict(zip(tree.joints, values, strict=True)))
    for geom, centre, turn in zip(posed.geoms, posed.centres, posed.rotations, strict=True):
        assert centre == pytest.approx(data.geom(geom.name).xpos, abs=1e-7), geom.name
        assert turn == pytest.approx(data.geom(geom.name).xmat.reshape(3, 3), abs=1e-7), geom.name
    assert posed.centre_of_mass == pytest.approx(data.subtree_com[1], abs=1e-7)


@given(hands=HANDS, direction=directions)
def test_a_standing_body_reaches_as_far_as_its_compiled_geoms(hands, direction, infant_at):
    infant, tree = infant_at(9, hands), TREES[hands]
    unit = np.array(direction) / np.linalg.norm(direction)
    geoms = [geom for geom in tree.geoms if infant.model.geom(geom).group == 0]
    _, farthest_m = infant.span_m(unit, geoms)
    hip_m = infant.data.body("hip").xpos @ unit
    assert pose(tree, {}).extent(unit) == pytest.approx(farthest_m - hip_m, abs=1e-7)


def test_only_what_collides_is_solid():
    standing = pose(TREE, {})
    assert {geom.name for geom in standing.geoms} - {geom.name for geom in standing.solid.geoms} == {"neck"}


anatomies = st.sampled_from(("mitten", "five_finger")).map(lambda hands: assemble(hands, False))
bodies = st.builds(grow_average, st.floats(0, 24), anatomies)
bent_deg = st.fixed_dictionaries({"{side}_hip1": st.floats(-90, 0), "{side}_elbow": st.floats(-90, 0)})
turned = st.builds(Pose, st.floats(-90, 90), bent_deg)


STEP_RAD = math.radians(0.5)
GOLDEN = (math.sqrt(5) - 1) / 2


def rest(tree, wanted, precision_rad: float = 1e-7) -> tuple[float, float]:
    """Return the pitch [rad] at which a posed body rests, by plain search, and the height of its hip there [m]."""
    posed = pose(tree, pose_angles(tree, wanted))
    start = math.radians(wanted.pitch_deg)

    def height(pitch_rad: float) -> float:
        down = np.array([math.sin(pitch_rad), 0.0, -math.cos(pitch_rad)])
        return posed.solid.extent(down) - float(down @ posed.centre_of_mass)

    step = -STEP_RAD if height(start - STEP_RAD) < height(start + STEP_RAD) else STEP_RAD
    steps = (start + step * number for number in count())
    lowest = next(here for here, there in pairwise(steps) if height(there) >= height(here))
    low, high = lowest - STEP_RAD, lowest + STEP_RAD
    while high - low > precision_rad:
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        low, high = (low, right) if height(left) < height(right) else (left, high)
    pitch_rad = (low + high) / 2
    down = np.array([math.sin(pitch_rad), 0.0, -math.cos(pitch_rad)])
    return pitch_rad, posed.solid.extent(down)


@settings(max_examples=3)
@given(bodies, st.sampled_from([*POSES]))
def test_a_body_rests_where_a_plain_search_finds_it(tree, name):
    state = resting_state(tree, poses_of(tree)[name])
    pitch_rad, height_m = rest(tree, poses_of(tree)[name])
    assert 2 * math.atan2(state[5], state[3]) == pytest.approx(pitch_rad, abs=2e-6)
    assert state[2] + CONTACT_DEPTH_M == pytest.approx(height_m, abs=1e-6)


@settings(max_examples=10)
@given(bodies, st.lists(turned, min_size=1, max_size=3))
def test_a_pose_is_the_same_to_the_bit_whatever_is_worked_out_with_it(tree, poses):
    wanted = [*poses_of(tree).values(), *poses]
    assert resting_states(tree, wanted) == [resting_state(tree, each) for each in wanted]


@settings(max_examples=5)
@given(bodies)
def test_several_poses_at_once_are_those_of_each_to_the_bit(tree):
    angles_rad = [pose_angles(tree, wanted) for wanted in poses_of(tree).values()]
    posed = pose_all(tree, angles_rad)
    for index, each in enumerate(pose(tree, angles) for angles in angles_rad):
        assert posed.geoms == each.geoms
        assert (posed.centres[index] == each.centres).all()
        assert (posed.rotations[index] == each.rotations).all()

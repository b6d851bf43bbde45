"""Poses at rest, worked out several at once, against a plain search."""

import math

import pytest
from hypothesis import given, settings, strategies as st
from support.resting import rest

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_average
from mimoc.body.kinematics import pose, pose_all
from mimoc.body.poses import CONTACT_DEPTH_M, POSES, Pose, pose_angles, poses_of, resting_state, resting_states

anatomies = st.sampled_from(("mitten", "five_finger")).map(lambda hands: assemble(hands, False))
bodies = st.builds(grow_average, st.floats(0, 24), anatomies)
bent_deg = st.fixed_dictionaries({"{side}_hip1": st.floats(-90, 0), "{side}_elbow": st.floats(-90, 0)})
turned = st.builds(Pose, st.floats(-90, 90), bent_deg)


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

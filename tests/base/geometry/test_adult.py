"""An adult's arms end where they are to, its links keep their lengths, and its face looks at what it is by."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from mimoc.base.geometry.adult import SIDES, SIGNS, Adult, Palm, neck, reach
from mimoc.base.geometry.reach import UP, leaning_pose
from mimoc.base.geometry.rotations import direction, matrix_from_axis
from mimoc.components.companions.body import PEAK, HandPath, minimum_jerk, turn_between, turned

angles = st.floats(-math.pi, math.pi)
places = st.tuples(*[st.floats(-1.0, 1.0)] * 3)
unit_vectors = st.builds(direction, angles, st.floats(-math.pi / 2, math.pi / 2))


@given(st.floats(0.85, 1.25), places, unit_vectors, st.sampled_from(SIDES))
def test_the_links_of_an_arm_keep_their_lengths_and_the_palm_is_where_it_is_to_be_if_it_can(scale, palm, normal, side):
    links, shoulder_m, palm_m = Adult(scale).links, np.array([0.0, 0.0, 0.5]), np.array(palm)
    outward = np.array([0.0, SIGNS[side], 0.0])
    (start, upper), (elbow, fore), (wrist, hand) = reach(links, shoulder_m, palm_m, normal, outward)
    assert (start == shoulder_m).all()
    assert np.linalg.norm(elbow - start) == pytest.approx(links.upper_arm_m)
    assert np.linalg.norm(wrist - elbow) == pytest.approx(links.forearm_m)
    assert start + links.upper_arm_m * upper[:, 2] == pytest.approx(elbow)
    assert elbow + links.forearm_m * fore[:, 2] == pytest.approx(wrist)
    for turn in (upper, fore, hand):
        assert turn.T @ turn == pytest.approx(np.eye(3), abs=1e-9)
        assert np.linalg.det(turn) == pytest.approx(1)
    far_m = np.linalg.norm(palm_m - shoulder_m)
    if 0.2 * scale < far_m < links.reach_m + links.palm_m:
        assert wrist + links.palm_m * hand[:, 2] == pytest.approx(palm_m)


@given(
    st.sampled_from(["in_front", "beside", "above"]), angles, st.floats(-1.4, 1.4), st.floats(0.2, 1.5), st.booleans()
)
def test_a_face_looks_at_the_other_and_the_body_is_above_the_floor(where, yaw_rad, pitch_rad, distance_m, to_left):
    turn = matrix_from_axis((0, 0, 1), yaw_rad) @ matrix_from_axis((0, 1, 0), pitch_rad)
    face = np.array([0.2, -0.1, 0.3]), turn
    adult = Adult(1.0)
    leaning = leaning_pose(adult.figure, face, where, to_left, distance_m, None)
    head_m, head = leaning.head
    way_m = face[0] - (head_m + adult.figure.face_m * head[:, 0])
    assert head[:, 0] @ way_m == pytest.approx(np.linalg.norm(way_m))
    assert head_m[2] >= adult.figure.crown_m - 0.1
    for _, axes in (leaning.head, leaning.trunk, neck(leaning)):
        assert axes.T @ axes == pytest.approx(np.eye(3), abs=1e-9)
    hips_m = leaning.trunk[0] - adult.figure.trunk_m * leaning.trunk[1][:, 2]
    assert hips_m[2] >= min(leaning.trunk[0][2], adult.figure.hip_m) - 1e-9
    for side in SIDES:
        assert adult.resting(leaning.trunk, side).place_m[2] > 0


def test_hands_start_and_end_at_rest_with_the_peak_speed_of_minimum_jerk():
    """Straight ahead, at 1.875 times the mean speed."""
    start, end = Palm(np.zeros(3), -UP), Palm(np.array([0.4, 0.0, 0.0]), -UP)
    path = HandPath.between(start, end, np.array([0.2, 0.0, 0.0]), 0.005)
    places_m = np.array([path.at(step).place_m[0] for step in range(path.steps + 1)])
    assert places_m[[0, -1]] == pytest.approx([0.0, 0.4])
    speeds = np.diff(places_m) / 0.005
    assert speeds.max() == pytest.approx(0.6, rel=0.02)
    assert speeds[[0, -1]] == pytest.approx([0.0, 0.0], abs=0.01)
    assert minimum_jerk(0.5) == 0.5
    assert (minimum_jerk(0.501) - minimum_jerk(0.499)) / 0.002 == pytest.approx(PEAK, rel=1e-4)


@given(unit_vectors, st.floats(0.01, 3.0), st.floats(0.0, 1.0))
def test_a_share_of_a_turn_is_a_turn_by_that_share_of_its_angle(axis, angle_rad, share):
    start = matrix_from_axis((0.3, 0.5, -0.2), 0.7)
    end = matrix_from_axis(axis, angle_rad) @ start
    assert turn_between(start, end)[1] == pytest.approx(angle_rad, abs=1e-6)
    assert turned(start, end, share) == pytest.approx(matrix_from_axis(axis, share * angle_rad) @ start, abs=1e-6)

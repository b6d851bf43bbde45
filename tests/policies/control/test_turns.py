import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.spatial.transform import Rotation

from mimoc.policies.control.objectives import directions_across, rotation_vector, turn_towards

vectors = st.tuples(*[st.floats(-1, 1)] * 3).map(np.array).filter(lambda vector: np.linalg.norm(vector) > 0.1)
unit_vectors = vectors.map(lambda vector: vector / np.linalg.norm(vector))
rotations = st.tuples(unit_vectors, st.floats(-3.1, 3.1)).map(lambda pair: Rotation.from_rotvec(pair[0] * pair[1]))


@given(rotations, rotations)
def test_a_turn_to_an_orientation_leads_there(here, there):
    turn = rotation_vector(here.as_matrix(), there.as_matrix())
    assert (Rotation.from_rotvec(turn) * here).as_matrix() == pytest.approx(there.as_matrix(), abs=1e-7)
    assert np.linalg.norm(turn) <= np.pi + 1e-9


@given(unit_vectors, unit_vectors)
def test_a_turn_to_a_direction_leads_there_about_an_axis_across_both(here, there):
    turn = turn_towards(here, there)
    assert Rotation.from_rotvec(turn).apply(here) == pytest.approx(there, abs=1e-7)
    assert abs(turn @ here) < 1e-9


@given(unit_vectors)
def test_there_is_no_turn_to_the_same_direction_and_half_a_turn_to_the_opposite_one(direction):
    assert not turn_towards(direction, direction).any()
    back = turn_towards(direction, -direction)
    assert np.linalg.norm(back) == pytest.approx(np.pi)
    assert abs(back @ direction) < 1e-9


@given(unit_vectors)
def test_directions_across_are_at_right_angles(direction):
    frame = np.stack([direction, *directions_across(direction)])
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-12)

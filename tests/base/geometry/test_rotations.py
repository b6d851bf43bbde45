"""Rotations are SciPy's."""

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.spatial.transform import Rotation

from mimoc.base.geometry.rotations import (
    cross,
    direction,
    matrix_from_axis,
    matrix_from_euler,
    matrix_from_quaternion,
    quaternion_between,
    quaternion_from_axis,
    quaternion_from_matrix,
    quaternion_product,
)

numbers = st.floats(-1, 1)
vectors = st.tuples(numbers, numbers, numbers).filter(lambda v: np.linalg.norm(v) > 0.01).map(np.array)
units = vectors.map(lambda v: v / np.linalg.norm(v))
angles_rad = st.floats(-7, 7)
quaternions = st.tuples(numbers, numbers, numbers, numbers).filter(lambda q: np.linalg.norm(q) > 0.01)


def rotation(quaternion) -> Rotation:
    return Rotation.from_quat(quaternion, scalar_first=True)


@given(angles_deg=st.tuples(*[st.floats(-400, 400)] * 3))
def test_euler_angles_are_intrinsic_x_y_z(angles_deg):
    wanted = Rotation.from_euler("XYZ", angles_deg, degrees=True).as_matrix()
    np.testing.assert_allclose(matrix_from_euler(angles_deg), wanted, atol=1e-12)


def test_what_is_remembered_of_euler_angles_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        matrix_from_euler((1.0, 2.0, 3.0))[0] = 0


@given(axis=vectors, angle_rad=angles_rad)
def test_the_axis_of_a_matrix_may_have_any_length(axis, angle_rad):
    wanted = Rotation.from_rotvec(angle_rad * axis / np.linalg.norm(axis)).as_matrix()
    np.testing.assert_allclose(matrix_from_axis(axis, angle_rad), wanted, atol=1e-12)


@given(axis=units, angle_rad=angles_rad)
def test_a_quaternion_about_an_axis_is_of_unit_length(axis, angle_rad):
    quaternion = quaternion_from_axis(axis, angle_rad)
    assert np.linalg.norm(quaternion) == pytest.approx(1)
    np.testing.assert_allclose(matrix_from_quaternion(quaternion), matrix_from_axis(axis, angle_rad), atol=1e-12)


@given(quaternion=quaternions)
def test_a_quaternion_may_have_any_length_and_comes_back_with_unit_length(quaternion):
    matrix = matrix_from_quaternion(quaternion)
    np.testing.assert_allclose(matrix, rotation(quaternion).as_matrix(), atol=1e-12)
    back = quaternion_from_matrix(matrix)
    assert np.linalg.norm(back) == pytest.approx(1)
    assert next(number for number in back if abs(number) > 1e-9) > 0
    np.testing.assert_allclose(matrix_from_quaternion(back), matrix, atol=1e-12)


@given(second=quaternions, first=quaternions)
def test_a_product_does_the_right_one_first(second, first):
    wanted = matrix_from_quaternion(second) @ matrix_from_quaternion(first)
    np.testing.assert_allclose(matrix_from_quaternion(quaternion_product(second, first)), wanted, atol=1e-12)


@given(start=units, end=units)
def test_the_rotation_between_two_directions_is_the_smallest(start, end):
    between = quaternion_between(start, end)
    np.testing.assert_allclose(matrix_from_quaternion(between) @ start, end, atol=1e-9)
    assert rotation(between).magnitude() == pytest.approx(np.arccos(np.clip(start @ end, -1, 1)), abs=1e-6)


@given(start=units)
def test_between_opposite_directions_it_is_half_a_turn(start):
    between = quaternion_between(start, -start)
    assert between[0] == 0
    np.testing.assert_allclose(matrix_from_quaternion(between) @ start, -start, atol=1e-12)


@pytest.mark.parametrize(
    ("azimuth_deg", "elevation_deg", "wanted"), [(0, 0, (1, 0, 0)), (90, 0, (0, 1, 0)), (0, 90, (0, 0, 1))]
)
def test_azimuth_goes_from_x_to_y_and_elevation_up(azimuth_deg, elevation_deg, wanted):
    found = direction(np.radians(azimuth_deg), np.radians(elevation_deg))
    np.testing.assert_allclose(found, wanted, atol=1e-15)


@given(st.lists(st.tuples(vectors, vectors), min_size=1, max_size=3))
def test_cross_products_are_numpys_to_the_bit(pairs):
    one, other = np.array(pairs).swapaxes(0, 1)
    assert cross(one, other).tobytes() == np.cross(one, other).tobytes()
    assert cross(one[0], other[0]).tobytes() == np.cross(one[0], other[0]).tobytes()

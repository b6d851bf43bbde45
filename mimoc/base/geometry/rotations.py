"""Rotations as matrices and as quaternions w, x, y, z.

This is NumPy alone, since SciPy's `Rotation` takes longer to import than an infant takes to build; the tests compare
the two.
"""

import math
from collections.abc import Sequence
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]
Vec3 = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]  # w, x, y, z.

OPPOSITE = 1e-9  # 1 plus the cosine of two directions, below which they leave the axis of the turn between them open.


@cache
def matrix_from_euler(euler_deg: Vec3) -> FloatArray:
    """Return the rotation by intrinsic x-y-z angles, shape (3, 3), read-only."""
    x, y, z = (matrix_from_axis(axis, math.radians(angle)) for axis, angle in zip(np.eye(3), euler_deg, strict=True))
    matrix = x @ y @ z
    matrix.flags.writeable = False
    return matrix


def matrices_from_axes(axes: Sequence[Sequence[float]], angles_rad: Sequence[Sequence[float]]) -> FloatArray:
    """Return what `matrix_from_axis` does, to the bit, of n axes with p angles each, shape (n, p, 3, 3)."""
    lengths = np.array([math.hypot(*axis) for axis in axes])
    x, y, z = (np.array(axes) / lengths[:, None]).T[:, :, None]
    sine = np.array([[math.sin(angle) for angle in angles] for angles in angles_rad])
    cosine = np.array([[math.cos(angle) for angle in angles] for angles in angles_rad])
    return np.stack(_rotation(x, y, z, sine, cosine), axis=-1).reshape(*sine.shape, 3, 3)


def matrix_from_axis(axis: Sequence[float] | FloatArray, angle_rad: float) -> FloatArray:
    """Return the rotation about an axis of any length, shape (3, 3) (Rodrigues 1840)."""
    x, y, z = axis
    length = math.hypot(x, y, z)
    entries = _rotation(x / length, y / length, z / length, math.sin(angle_rad), math.cos(angle_rad))
    return np.array(entries).reshape(3, 3)


def _rotation(x: Any, y: Any, z: Any, sine: Any, cosine: Any) -> tuple[Any, ...]:
    rest = 1 - cosine
    return (
        *(cosine + rest * x * x, rest * x * y - sine * z, rest * x * z + sine * y),
        *(rest * x * y + sine * z, cosine + rest * y * y, rest * y * z - sine * x),
        *(rest * x * z - sine * y, rest * y * z + sine * x, cosine + rest * z * z),
    )


def matrix_from_quaternion(quaternion: Sequence[float]) -> FloatArray:
    """Return the rotation of a quaternion of any length but 0, shape (3, 3)."""
    w, x, y, z = quaternion
    double = 2 / (w * w + x * x + y * y + z * z)
    return np.array(
        [
            [1 - double * (y * y + z * z), double * (x * y - w * z), double * (x * z + w * y)],
            [double * (x * y + w * z), 1 - double * (x * x + z * z), double * (y * z - w * x)],
            [double * (x * z - w * y), double * (y * z + w * x), 1 - double * (x * x + y * y)],
        ]
    )


def quaternion_from_matrix(rotation: FloatArray) -> Quaternion:
    """Return a rotation, shape (3, 3), as a unit quaternion whose first number that is not 0 is positive.

    Its largest number is worked out first, from the diagonal, and the others by dividing by it (Shepperd 1978).
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation.tolist()
    rows = (
        (1 + xx + yy + zz, zy - yz, xz - zx, yx - xy),
        (zy - yz, 1 + xx - yy - zz, xy + yx, xz + zx),
        (xz - zx, xy + yx, 1 - xx + yy - zz, yz + zy),
        (yx - xy, xz + zx, yz + zy, 1 - xx - yy + zz),
    )
    largest = max(range(4), key=lambda index: rows[index][index])
    length = math.copysign(math.hypot(*rows[largest]), next(number for number in rows[largest] if abs(number) > 1e-12))
    w, x, y, z = (number / length for number in rows[largest])
    return w, x, y, z


def quaternion_from_axis(axis: Vec3, angle_rad: float) -> Quaternion:
    """Return the rotation about a unit vector, counterclockwise for a viewer towards whom it points."""
    sine = math.sin(angle_rad / 2)
    return math.cos(angle_rad / 2), sine * axis[0], sine * axis[1], sine * axis[2]


def quaternion_between(start: FloatArray, end: FloatArray) -> Quaternion:
    """Return the smallest rotation that takes one unit vector to another, shape (3,) each.

    Between opposite vectors it is half a turn about the axis, of x, y and z, that is nearest to being across.
    """
    cosine = float(start @ end)
    if 1 + cosine < OPPOSITE:
        across = np.eye(3)[np.abs(start).argmin()]
        x, y, z = (across - (across @ start) * start).tolist()
        return _normalised((0.0, x, y, z))
    x, y, z = cross(start, end).tolist()
    return _normalised((1 + cosine, x, y, z))


def quaternion_product(second: Quaternion, first: Quaternion) -> Quaternion:
    """Return the rotation that does one after the other."""
    a, b, c, d = second
    w, x, y, z = first
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def direction(azimuth_rad: float, elevation_rad: float) -> FloatArray:
    """Return the unit vector, shape (3,), at an azimuth from x towards y and an elevation above the horizontal."""
    level = math.cos(elevation_rad)
    return np.array([level * math.cos(azimuth_rad), level * math.sin(azimuth_rad), math.sin(elevation_rad)])


def _normalised(quaternion: Quaternion) -> Quaternion:
    w, x, y, z = quaternion
    length = math.hypot(w, x, y, z)
    return w / length, x / length, y / length, z / length


def cross(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the cross products of vectors, shape (..., 3): to the bit as `numpy.cross`, which few vectors wait for."""
    return one.take(_NEXT, -1) * other.take(_LAST, -1) - one.take(_LAST, -1) * other.take(_NEXT, -1)


_NEXT, _LAST = np.array([1, 2, 0]), np.array([2, 0, 1])
"""Index of the next and of the last but one axis, by axis: the factors of a cross product."""

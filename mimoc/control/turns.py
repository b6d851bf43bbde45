"""Rotation vectors from one orientation or direction to another."""

import math

import mujoco
import numpy as np

from mimoc.senses.sense import FloatArray

_PARALLEL = 1e-9
"""Sine of the angle below which two directions do not determine an axis of rotation."""


def turn_to(axes: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return the rotation vector, shape (3,), [rad], in the world, from one orientation to another.

    It is the logarithm of R* Rᵀ, at most half a turn long.

    Args:
        axes: Present axes, as columns, shape (3, 3).
        wanted: Target axes, as columns, shape (3, 3).
    """
    quaternion, turn = np.empty(4), np.empty(3)
    mujoco.mju_mat2Quat(quaternion, (wanted @ axes.T).ravel())
    mujoco.mju_quat2Vel(turn, quaternion, 1.0)
    return turn


def turn_towards(pointing: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return the shortest rotation vector, shape (3,), [rad], from one direction to another.

    It is zero if they are equal, and about an arbitrary perpendicular axis if they are opposite.

    Args:
        pointing: Present direction, a unit vector, shape (3,).
        wanted: Target direction, a unit vector, shape (3,).
    """
    across, along = _cross(pointing, wanted), float(pointing @ wanted)
    sine = math.sqrt(across @ across)
    if sine > _PARALLEL:
        return math.atan2(sine, along) / sine * across
    return np.zeros(3) if along > 0 else math.pi * directions_across(pointing)[0]


def directions_across(direction: FloatArray) -> FloatArray:
    """Return two unit vectors, shape (2, 3), that are orthogonal to a unit vector and to each other."""
    least = np.zeros(3)
    least[np.abs(direction).argmin()] = 1.0
    across = np.empty((2, 3))
    across[0] = _cross(direction, least)
    across[0] /= math.sqrt(across[0] @ across[0])
    across[1] = _cross(direction, across[0])
    return across


def _cross(left: FloatArray, right: FloatArray) -> FloatArray:
    """Return the cross product, shape (3,); of two single vectors NumPy's takes twenty times as long."""
    product = np.empty(3)
    mujoco.mju_cross(product, left, right)
    return product

"""The surface of a geom: its points, its area, depth below it, and the direction to it from inside."""

import math

import numpy as np
import numpy.typing as npt

from mimoc.body import Geom
from mimoc.body.kinematics import euler_matrix

FloatArray = npt.NDArray[np.float64]


def place(geom: Geom, multiples: FloatArray) -> FloatArray:
    """Return points given as multiples of the sizes of a geom, shape (n, 3), in the frame of its body.

    Args:
        geom: The geom.
        multiples: Of its radii or half edges along x, y and z of its own frame, then of the half length of the axis
            of a capsule, shape (n, 4).
    """
    local = multiples[:, :3] * _radii_m(geom)
    local[:, 2] += multiples[:, 3] * _axis_m(geom)
    return local @ euler_matrix(geom.euler_deg).T + geom.pos_m


def depth(geom: Geom, points_m: FloatArray) -> FloatArray:
    """Return the depth of places inside a geom, shape (n,); outside it is negative, at most the distance.

    Args:
        geom: The geom.
        points_m: Shape (n, 3), in the frame of its body.
    """
    local = _local(geom, points_m)
    if geom.type == "box":
        return (_radii_m(geom) - np.abs(local)).min(axis=1)
    if geom.type == "cylinder":
        return _depths_in_cylinder(local, *geom.size_m).min(axis=1)
    return geom.size_m[0] - np.linalg.norm(_from_axis(geom, local), axis=1)


def outward(geom: Geom, points_m: FloatArray) -> FloatArray:
    """Return the directions to the nearest points of a geom's surface from places inside of it, shape (n, 3).

    Args:
        geom: The geom.
        points_m: Shape (n, 3), in the frame of its body.
    """
    local = _local(geom, points_m)
    if geom.type == "box":
        nearest = (_radii_m(geom) - np.abs(local)).argmin(axis=1)
        ways = np.where(np.arange(3) == nearest[:, None], np.copysign(1.0, local), 0.0)
    elif geom.type == "cylinder":
        by_side, by_end = _depths_in_cylinder(local, *geom.size_m).T
        ends = np.copysign((0.0, 0.0, 1.0), local)
        ways = np.where((by_end < by_side)[:, None], ends, _unit(local * (1, 1, 0)))
    else:
        ways = _unit(_from_axis(geom, local))
    return ways @ euler_matrix(geom.euler_deg).T


def area_m2(geom: Geom) -> float:
    """Return the area of the whole surface."""
    if geom.type == "box":
        x, y, z = geom.size_m
        return 8 * (x * y + y * z + z * x)
    radius_m = geom.size_m[0]
    if geom.type == "cylinder":
        return 2 * math.pi * radius_m * (2 * geom.size_m[1] + radius_m)
    return 4 * math.pi * radius_m * (_axis_m(geom) + radius_m)


def _radii_m(geom: Geom) -> FloatArray:
    """Return radii, or half edges, along x, y and z."""
    if geom.type == "box":
        return np.array(geom.size_m)
    radius_m = geom.size_m[0]
    return np.array((radius_m, radius_m, geom.size_m[1] if geom.type == "cylinder" else radius_m))


def _axis_m(geom: Geom) -> float:
    """Return half the length of the axis that a capsule is drawn around."""
    return geom.size_m[1] if geom.type == "capsule" else 0.0


def _local(geom: Geom, points_m: FloatArray) -> FloatArray:
    return (points_m - geom.pos_m) @ euler_matrix(geom.euler_deg)


def _from_axis(geom: Geom, local: FloatArray) -> FloatArray:
    """Return the vectors from the nearest points of a capsule's axis, or from a sphere's centre."""
    half_m, vectors = _axis_m(geom), local.copy()
    vectors[:, 2] -= np.clip(local[:, 2], -half_m, half_m)
    return vectors


def _depths_in_cylinder(local: FloatArray, radius_m: float, half_m: float) -> FloatArray:
    """Return how far the round side and the nearer end are from places inside, shape (n, 2)."""
    return np.column_stack((radius_m - np.hypot(local[:, 0], local[:, 1]), half_m - np.abs(local[:, 2])))


def _unit(vectors: FloatArray) -> FloatArray:
    """Return vectors of length one; along x where there is no direction."""
    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(lengths > 0, vectors, (1.0, 0.0, 0.0)) / np.where(lengths > 0, lengths, 1.0)

"""The surface of a geom in the frame of its body: points, depth below it, and the direction to it from inside."""

import numpy as np

from mimoc.body import Geom
from mimoc.geometry import primitives
from mimoc.geometry.rotations import FloatArray, matrix_from_euler


def place(geom: Geom, multiples: FloatArray) -> FloatArray:
    """Return points given as multiples of the sizes of a geom, shape (n, 3), in the frame of its body.

    Args:
        geom: The geom.
        multiples: Of its radii or half edges along x, y and z of its own frame, then of the half length of the axis
            of a capsule, shape (n, 4).
    """
    local = multiples[:, :3] * _radii_m(geom)
    local[:, 2] += multiples[:, 3] * _axis_m(geom)
    return local @ matrix_from_euler(geom.euler_deg).T + geom.pos_m


def depth(geom: Geom, points_m: FloatArray) -> FloatArray:
    """Return the depth of places inside a geom, shape (n,); outside it is negative, at most the distance.

    Args:
        geom: The geom.
        points_m: Shape (n, 3), in the frame of its body.
    """
    return primitives.depths(geom.type, geom.size_m, _local(geom, points_m))


def outward(geom: Geom, points_m: FloatArray) -> FloatArray:
    """Return the directions to the nearest points of a geom's surface from places inside of it, shape (n, 3).

    Args:
        geom: The geom.
        points_m: Shape (n, 3), in the frame of its body.
    """
    ways = primitives.outward(geom.type, geom.size_m, _local(geom, points_m))
    return ways @ matrix_from_euler(geom.euler_deg).T


def _radii_m(geom: Geom) -> FloatArray:
    """Return radii, half axes or half edges along x, y and z."""
    if geom.type in ("box", "ellipsoid"):
        return np.array(geom.size_m)
    radius_m = geom.size_m[0]
    return np.array((radius_m, radius_m, geom.size_m[1] if geom.type == "cylinder" else radius_m))


def _axis_m(geom: Geom) -> float:
    """Return half the length of the axis that a capsule is drawn around."""
    return geom.size_m[1] if geom.type == "capsule" else 0.0


def _local(geom: Geom, points_m: FloatArray) -> FloatArray:
    return (points_m - geom.pos_m) @ matrix_from_euler(geom.euler_deg)

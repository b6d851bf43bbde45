"""Pieces of objects: solids, what is only seen, strings and bars, and the damping of a swing."""

import math
from dataclasses import replace

import numpy as np

from mimoc.base.geometry.rotations import Quaternion, Vec3, quaternion_between
from mimoc.base.units import GRAVITY_M_S2
from mimoc.body.kinematics import FloatArray
from mimoc.compiler.mjcf.furniture import UNTOUCHED
from mimoc.compiler.mjcf.world import ObjectGeom
from mimoc.compiler.toys.shape import UPRIGHT

DAMPING_RATIO = 0.05
"""Of what hangs: a swing falls to a third in about three and a half periods; an assumption."""
STRING_M = 0.001
"""Radius of a string."""
CONDIM = {"sphere": 6, "ellipsoid": 6, "cylinder": 6, "capsule": 6, "box": 4}
"""`condim`: 4 is sliding and spinning friction, 6 adds rolling friction, without which what is round never rests."""


def seen(
    name: str, material: str, shape: str, size_m: tuple[float, ...], pos_m: Vec3, quat: Quaternion = UPRIGHT
) -> ObjectGeom:
    """Return a primitive without contacts or mass."""
    sizes = (("size", size_m),)
    return ObjectGeom(name, shape, material, sizes, (), pos_m, quat, contype=UNTOUCHED, conaffinity=UNTOUCHED, group=1)


def solid(
    name: str,
    material: str,
    shape: str,
    size_m: tuple[float, ...],
    pos_m: Vec3,
    mass_kg: float,
    quat: Quaternion = UPRIGHT,
) -> ObjectGeom:
    """Return a primitive that touches things, sized as in MuJoCo, whose material has this name."""
    sizes = (("size", size_m),)
    return ObjectGeom(name, shape, material, sizes, (), pos_m, quat, mass_kg, condim=CONDIM[shape])


def bar(name: str, material: str, radius_m: float, start_m: FloatArray, end_m: FloatArray) -> ObjectGeom:
    """Return a capsule between two points, shape (3,) each."""
    length_m = float(np.linalg.norm(end_m - start_m))
    x_m, y_m, z_m = ((start_m + end_m) / 2).tolist()
    quat = quaternion_between(np.array([0.0, 0.0, 1.0]), (end_m - start_m) / length_m)
    return seen(name, material, "capsule", (radius_m, length_m / 2), (x_m, y_m, z_m), quat)


def string(name: str, material: str, length_m: float) -> ObjectGeom:
    """Return a string from the origin down."""
    return seen(name, material, "capsule", (STRING_M, length_m / 2), (0.0, 0.0, -length_m / 2))


def moved(geom: ObjectGeom, by_m: Vec3) -> ObjectGeom:
    """Return a geom elsewhere in its body."""
    x_m, y_m, z_m = np.add(geom.pos_m, by_m).tolist()
    return replace(geom, pos_m=(x_m, y_m, z_m))


def pendulum_damping(*hanging: tuple[float, float, float]) -> float:
    """Return the damping of a ball joint that bodies hang from, in [N m s/rad]: c = 2 z sqrt(g (sum m l) (sum I)).

    Args:
        hanging: Of each body, its mass m, the distance l from the joint to its centre, and about how large it is, r:
            its moment of inertia about the joint is I = m (l² + 2 r² / 5).
    """
    moment_kgm = math.fsum(mass_kg * length_m for mass_kg, length_m, _ in hanging)
    inertia_kgm2 = math.fsum(mass_kg * (length_m**2 + 0.4 * radius_m**2) for mass_kg, length_m, radius_m in hanging)
    return 2 * DAMPING_RATIO * math.sqrt(GRAVITY_M_S2 * moment_kgm * inertia_kgm2)

"""The volume of a part, which its mass and strength grow with; its mass is that times its `density`."""

import math

from mimoc.body.tree import GeomType


def volume(kind: GeomType, size_m: tuple[float, ...]) -> float:
    """Return the volume of a geom, in m³, from its size as MuJoCo wants it."""
    if kind == "box":
        x, y, z = size_m
        return 8 * x * y * z
    radius = size_m[0]
    ball = 4 / 3 * math.pi * radius**3
    if kind == "sphere":
        return ball
    cylinder = math.pi * radius**2 * 2 * size_m[1]
    return cylinder if kind == "cylinder" else cylinder + ball

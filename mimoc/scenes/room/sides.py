"""Floor, ceiling and walls of a room."""

import math
from dataclasses import dataclass

from mimoc.geometry.rotations import Vec3
from mimoc.looks.wallpaper import Wallpaper
from mimoc.mjcf.furniture import SOLID, UNTOUCHED, WorldGeom
from mimoc.mjcf.materials import UNTINTED, WorldMaterial

QUADS = 16
"""Facets along a side: MuJoCo computes light at their corners only."""
SIDES = ("floor", "ceiling", "wall_front", "wall_back", "wall_left", "wall_right")


@dataclass(frozen=True, slots=True)
class Side:
    """One of the six planes; looking at it from inside, its x points right and its y up."""

    name: str
    extent_m: tuple[float, float]
    pos_m: Vec3
    euler_rad: Vec3
    inwards: Vec3
    """Where its z points."""


def sides(depth: float, width: float, height: float) -> tuple[Side, ...]:
    """Return floor, ceiling and walls: before, behind, left and right of one who looks along x."""
    upright = math.pi / 2
    middle = height / 2
    return (
        Side("floor", (depth, width), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 1.0)),
        Side("ceiling", (depth, width), (0.0, 0.0, height), (math.pi, 0.0, 0.0), (0.0, 0.0, -1.0)),
        Side("wall_front", (width, height), (depth / 2, 0.0, middle), (upright, -upright, 0.0), (-1.0, 0.0, 0.0)),
        Side("wall_back", (width, height), (-depth / 2, 0.0, middle), (upright, upright, 0.0), (1.0, 0.0, 0.0)),
        Side("wall_left", (depth, height), (0.0, width / 2, middle), (upright, 0.0, 0.0), (0.0, -1.0, 0.0)),
        Side("wall_right", (depth, height), (0.0, -width / 2, middle), (upright, math.pi, 0.0), (0.0, 1.0, 0.0)),
    )


def plane(side: Side) -> WorldGeom:
    """Return the geom of a side; of these, only the floor touches by contact bits."""
    across, up = side.extent_m
    barrier = side.name != "floor"
    return WorldGeom(
        side.name,
        "plane",
        (across / 2, up / 2, max(across, up) / QUADS),
        side.pos_m,
        side.euler_rad,
        side.name,
        contype=UNTOUCHED if barrier else SOLID,
        conaffinity=UNTOUCHED if barrier else SOLID,
        barrier=barrier,
    )


def papered(side: Side, paper: Wallpaper) -> WorldMaterial:
    """Return the material of a side: its texture at its real size."""
    across, up = (
        extent / tile if math.isfinite(tile) else 1.0 for extent, tile in zip(side.extent_m, paper.tile_m, strict=True)
    )
    return WorldMaterial(side.name, UNTINTED, paper.name, (across, up))

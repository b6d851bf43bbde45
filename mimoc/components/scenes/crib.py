"""A crib with bars to look through and a rail to pull up on."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from mimoc.base.geometry.rotations import Vec3
from mimoc.base.units import cm_to_m
from mimoc.body.kinematics import stature
from mimoc.body.origins import Entry
from mimoc.compiler.looks.wallpaper import WALLS, Wallpapers
from mimoc.compiler.mjcf.elements import (
    DOMINANT_SOLMIX,
    RAIL_IN_CHILDREN,
    RAIL_RADIUS_M,
    Furniture,
    WorldGeom,
    WorldMaterial,
    WorldTexture,
    untouched,
)
from mimoc.compiler.mjcf.world import Ground, World
from mimoc.compiler.scenes import HEADLIGHT, WINDOW, BuiltScene, Occupant
from mimoc.schema.scene import SceneSpec

INNER_M = (1.2, 0.6)  # Length and width inside, of the common kind (EN 716-1); more for a child that would not fit.
LENGTH_IN_CHILDREN = 1.25  # Least length inside, in lengths of the child.
BAR_RADIUS_M = 0.006  # A hand closes around bars, too: their girth is 4 cm, a newborn's hand is 6 cm long.
WIDEST_GAP_M = 0.058  # Between two bars: EN 716-1 asks for 45 to 65 mm.
POST_HALF_M = 0.02
MATTRESS_M = 0.1  # Its thickness.
LEGS_M = 0.3  # From the floor to the top of the mattress.
SHEET, SHEET_TILE_M = WALLS["stars"], 0.4
SHEET_M = 0.001  # Its thickness, so that it is not hidden in the mattress.
FREE_M = 0.01  # Between the bars and a child in any of its poses.
KNOB_M = 0.02  # Height of a post above the rail.
SOFT_SOLREF = (0.04, 1.0)
SOFT_SOLIMP = (0.7, 0.95, 0.02, 0.5, 2.0)  # Foam: an infant sinks in by a few millimetres.

_UNTURNED = (0.0, 0.0, 0.0)
_ALONG_X = (0.0, math.pi / 2, 0.0)
_ALONG_Y = (math.pi / 2, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Crib:
    """A crib around the origin, its length along x, the top of its mattress at z = 0."""

    inner_m: tuple[float, float]  # Length and width inside.
    rail_height_m: float  # Height of the middle of the rail above the mattress.
    furniture: Furniture


def build(spec: SceneSpec, occupant: Occupant, wallpapers: Wallpapers) -> BuiltScene:
    """Return a crib that fits the infant, which lies on its mattress."""
    x_m, y_m = (np.abs(occupant.discs[:, :2]) + occupant.discs[:, 2:]).max(axis=0).tolist()
    made = crib(cm_to_m(stature(occupant.body)["length_cm"]), (x_m, y_m))
    length, width = made.inner_m
    world = World(grounds=(Ground("floor", -LEGS_M),), lights=(WINDOW,), headlight=HEADLIGHT, furniture=made.furniture)
    return BuiltScene(world, half_size_m=(length / 2, width / 2), origins=_origins(made))


def crib(length_m: float, reach_m: tuple[float, float] = (0.0, 0.0)) -> Crib:
    """Return a crib for a child of a length from crown to sole, which reaches so far from the middle along x and y."""
    least_length, least_width = (2 * (reach + FREE_M) for reach in reach_m)
    inner = (max(INNER_M[0], LENGTH_IN_CHILDREN * length_m, least_length), max(INNER_M[1], least_width))
    rail = RAIL_IN_CHILDREN * length_m
    return Crib(
        inner,
        rail,
        Furniture(
            geoms=(*_bed(*inner), *_posts(*inner, rail), *_rails(*inner, rail), *_bars(*inner, rail)),
            materials=_materials(inner),
            textures=(WorldTexture(SHEET.name, f"assets/{SHEET.name}.png", SHEET.png),),
        ),
    )


def _origins(made: Crib) -> dict[str, Entry]:
    size_rule = (
        f"inside: the common kind's (EN 716-1), or {LENGTH_IN_CHILDREN:g} x the child's length, or as far as it reaches"
    )
    rail_rule = f"above the mattress: {RAIL_IN_CHILDREN:.4g} x the child's length, as MIMo's is at 18 months"
    shared = {"unit": "m", "from": ["child.length_cm"]}
    return {
        "crib.size": {"value": made.inner_m, "rule": size_rule, **shared},
        "crib.rail_height": {"value": made.rail_height_m, "rule": rail_rule, **shared},
    }


def _materials(inner: tuple[float, float]) -> tuple[WorldMaterial, ...]:
    length, width = inner
    return (
        WorldMaterial("crib_sheet", (0.9, 0.9, 0.9, 1.0), SHEET.name, (length / SHEET_TILE_M, width / SHEET_TILE_M)),
        WorldMaterial("crib_mattress", (0.93, 0.92, 0.88, 1.0)),
        WorldMaterial("crib_wood", (0.82, 0.66, 0.46, 1.0)),
    )


def _bed(length: float, width: float) -> tuple[WorldGeom, ...]:
    """Return a mattress that is only seen, and a soft sheet on it for contacts.

    The sheet is a plane, which for physics has no end: between a box and a cylinder that stands on it, MuJoCo finds
    one contact at a time, and toys tremble. Toys thrown out of the crib rest beside it at the height of the sheet.
    """
    half = (length / 2, width / 2, (MATTRESS_M - SHEET_M) / 2)
    z = -(MATTRESS_M + SHEET_M) / 2
    mattress = untouched(WorldGeom("crib_mattress", "box", half, (0.0, 0.0, z), _UNTURNED, "crib_mattress"))
    sheet = WorldGeom(
        "crib_sheet",
        "plane",
        (length / 2, width / 2, SHEET_TILE_M / 4),
        (0.0, 0.0, 0.0),
        _UNTURNED,
        "crib_sheet",
        solref=SOFT_SOLREF,
        solimp=SOFT_SOLIMP,
        solmix=DOMINANT_SOLMIX,
    )
    return mattress, sheet


def _posts(length: float, width: float, rail: float) -> Iterator[WorldGeom]:
    top = rail + KNOB_M
    size = (POST_HALF_M, POST_HALF_M, (top + LEGS_M) / 2)
    for x_name, x in ("front", length / 2 + POST_HALF_M), ("back", -length / 2 - POST_HALF_M):
        for y_name, y in ("left", width / 2 + POST_HALF_M), ("right", -width / 2 - POST_HALF_M):
            pos = (x, y, (top - LEGS_M) / 2)
            yield WorldGeom(f"crib_post_{x_name}_{y_name}", "box", size, pos, _UNTURNED, "crib_wood")


def _rails(length: float, width: float, rail: float) -> Iterator[WorldGeom]:
    """Yield the rails to hold, and those below that carry the bars."""
    for name, z in ("rail", rail), ("ledge", -MATTRESS_M / 2):
        for side, turn, half_length, (x, y) in _sides(length, width):
            size = (RAIL_RADIUS_M, half_length)
            yield WorldGeom(f"crib_{name}_{side}", "capsule", size, (x, y, z), turn, "crib_wood")


def _sides(length: float, width: float) -> tuple[tuple[str, Vec3, float, tuple[float, float]], ...]:
    """Return name, direction, half length and middle of the rails on each side."""
    x, y = length / 2 + RAIL_RADIUS_M, width / 2 + RAIL_RADIUS_M
    return (
        ("front", _ALONG_Y, width / 2, (x, 0.0)),
        ("back", _ALONG_Y, width / 2, (-x, 0.0)),
        ("left", _ALONG_X, length / 2, (0.0, y)),
        ("right", _ALONG_X, length / 2, (0.0, -y)),
    )


def _bars(length: float, width: float, rail: float) -> Iterator[WorldGeom]:
    """Yield the bars, evenly between the posts, from ledge to rail."""
    low = -MATTRESS_M / 2
    size, z = (BAR_RADIUS_M, (rail - low) / 2), (rail + low) / 2
    for side, turn, half_length, (x, y) in _sides(length, width):
        for number, along in enumerate(_bar_positions(2 * half_length), start=1):
            pos = (x, along, z) if turn == _ALONG_Y else (along, y, z)
            yield WorldGeom(f"crib_bar_{side}_{number}", "capsule", size, pos, _UNTURNED, "crib_wood")


def _bar_positions(span: float) -> list[float]:
    """Return the positions of bars across a span: the fewest that leave no gap too wide."""
    thickness = 2 * BAR_RADIUS_M
    gaps = math.ceil((span + thickness) / (WIDEST_GAP_M + thickness))
    pitch = (span + thickness) / gaps
    return [number * pitch - (span + thickness) / 2 for number in range(1, gaps)]

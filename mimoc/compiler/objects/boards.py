"""What furniture is made of: boards and bars that are fixed to the world, hard or soft."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.errors import ObjectError, TextureError
from mimoc.base.geometry.primitives import extents, volume
from mimoc.base.geometry.rotations import (
    FloatArray,
    Quaternion,
    Vec3,
    matrix_from_euler,
    matrix_from_quaternion,
    quaternion_from_axis,
    quaternion_from_matrix,
)
from mimoc.base.units import GRAVITY_M_S2, cm_to_m
from mimoc.body.origins import Entry
from mimoc.compiler.looks.pictures import encode_png
from mimoc.compiler.looks.wallpaper import read_picture_file
from mimoc.compiler.mjcf.elements import (
    BARE,
    DOMINANT_SOLMIX,
    RAIL_RADIUS_M,
    UNTINTED,
    UNTOUCHED,
    Furniture,
    Rgba,
    WorldMaterial,
    WorldTexture,
)
from mimoc.compiler.mjcf.world import ObjectBody, ObjectGeom
from mimoc.compiler.objects.built_object import BuiltObject
from mimoc.schema.objects import MAX_CYCLES, GratingSpec, Material, PicturedSpec

AHEAD: Vec3 = (1.0, 0.0, 0.0)
ACROSS: Vec3 = (0.0, 1.0, 0.0)
UNTURNED: Quaternion = (1.0, 0.0, 0.0, 0.0)
LYING: Quaternion = quaternion_from_axis(AHEAD, math.pi / 2)  # Orientation of a bar along y.
DENSITIES_KG_M3: Mapping[str, float] = {"wood": 600.0, "cloth": 50.0}
"""Densities of beech and pine, and of foam; assumptions, which move nothing: furniture is fixed."""
MIN_DISC_M = 0.1
"""Side of the squares into which long, thin furniture is divided to cover the floor below it with discs."""
SOFT_IMPEDANCE = (0.7, 0.95)
"""Impedance of a soft contact without depth, and at full width: those of the crib's mattress."""
SOFT_WIDTH = 4.0  # Width of the rise of a soft contact's impedance, for one depth to which a body at rest sinks in.


@dataclass(frozen=True, slots=True)
class Surface:
    """A level surface about the origin, on which things can lie."""

    half_m: tuple[float, float]  # Half lengths along x and y.
    height_m: float


def soft_contact(sink_m: float) -> tuple[tuple[float, float], tuple[float, float, float, float, float]]:
    """Return `solref` and `solimp` of foam into which whatever rests on one point of it sinks by a depth r, *sink_m*.

    With time constant T, critical damping and impedance d at that depth, D at full width, MuJoCo's contact pushes with
    the acceleration d r / (D T)^2, and at rest it bears (1 - d) / d of gravity g with it. So r = (1 - d) g (D T / d)^2,
    whatever the mass, and T = d sqrt(r / ((1 - d) g)) / D. On n points, a body sinks in by about r / n.

    """
    least, most = SOFT_IMPEDANCE
    impedance = least + (most - least) * 2 / SOFT_WIDTH**2  # MuJoCo's sigmoid with power 2 and midpoint 0.5.
    time_s = impedance * math.sqrt(sink_m / ((1 - impedance) * GRAVITY_M_S2)) / most
    return (time_s, 1.0), (least, most, SOFT_WIDTH * sink_m, 0.5, 2.0)


def board(
    name: str, half_m: Vec3, middle_m: Vec3 | FloatArray, finish: WorldMaterial, tilt_deg: float = 0.0
) -> ObjectGeom:
    """Return a box, whose front, along x, is lifted by an angle."""
    return piece(name, "box", half_m, middle_m, quaternion_from_axis(ACROSS, -math.radians(tilt_deg)), finish)


def bar(name: str, half_m: float, middle_m: Vec3, finish: WorldMaterial, radius_m: float = RAIL_RADIUS_M) -> ObjectGeom:
    """Return a bar along y with round ends."""
    return piece(name, "capsule", (radius_m, half_m), middle_m, LYING, finish)


def post(
    name: str, radius_m: float, height_m: float, middle_m: tuple[float, float], finish: WorldMaterial
) -> ObjectGeom:
    """Return an upright cylinder that stands on the floor."""
    return piece(name, "cylinder", (radius_m, height_m / 2), (*middle_m, height_m / 2), UNTURNED, finish)


def piece(
    name: str, type: str, size_m: Sequence[float], middle_m: Vec3 | FloatArray, quat: Quaternion, finish: WorldMaterial
) -> ObjectGeom:
    """Return a solid that is as hard as a floor."""
    x, y, z = (float(number) for number in middle_m)
    sizes = (("size", tuple(size_m)),)
    return ObjectGeom(name, type, finish.name, sizes, (), (x, y, z), quat, friction=(1.0, 0.005, 0.0002))


def softened(geom: ObjectGeom, sink_m: float) -> ObjectGeom:
    """Return a piece as foam, into which whatever rests on one point of it sinks by a depth."""
    solref, solimp = soft_contact(sink_m)
    return replace(geom, solref=solref, solimp=solimp, solmix=DOMINANT_SOLMIX)


def seen(geom: ObjectGeom) -> ObjectGeom:
    """Return a piece that is only seen."""
    return replace(geom, contype=UNTOUCHED, conaffinity=UNTOUCHED)


def finish(name: str, colour: tuple[float, float, float], **looks: Any) -> WorldMaterial:
    """Return what a piece of furniture looks like."""
    return WorldMaterial(name, (*colour, 1.0), **looks)


def fixed_object(
    name: str,
    pieces: Sequence[ObjectGeom],
    finishes: Sequence[WorldMaterial],
    material: Material,
    surface: Surface | None = None,
    pictures: Furniture = BARE,
    origins: Mapping[str, Entry] | None = None,
) -> BuiltObject:
    """Return furniture that does not move, from its pieces in a frame on the floor, x ahead of an infant at it."""
    corners_m = np.concatenate([_corners(piece) for piece in pieces])
    volumes_m3 = [volume(*_shape(piece)) for piece in pieces if piece.contype]
    return BuiltObject(
        root=ObjectBody(name, geoms=tuple(pieces)),
        materials=tuple(finishes),
        motion="fixed",
        material=material,
        radius_m=float(np.hypot(*corners_m[:, :2].T).max()),
        height_m=surface.height_m if surface else float(corners_m[:, 2].max()),
        size_m=float(np.ptp(corners_m, axis=0).max()),
        mass_kg=DENSITIES_KG_M3[material] * math.fsum(volumes_m3),
        surface_m=surface.half_m if surface else None,
        discs=_discs(corners_m[:, :2]),
        pictures=pictures,
        origins=origins or {},
    )


def _discs(corners_m: FloatArray) -> tuple[Vec3, ...]:
    """Return discs that cover the rectangle around some places, shape (n, 2): x, y and radius, in [m]."""
    low, high = corners_m.min(axis=0), corners_m.max(axis=0)
    sides = high - low
    counts = np.ceil(sides / max(float(sides.min()), MIN_DISC_M)).astype(int)
    steps = sides / counts
    places = itertools.product(*(low[axis] + steps[axis] * (np.arange(counts[axis]) + 0.5) for axis in range(2)))
    return tuple((float(x), float(y), float(np.hypot(*steps)) / 2) for x, y in places)


def _shape(piece: ObjectGeom) -> tuple[Any, tuple[float, ...]]:
    size_m = piece.sizes[0][1]
    return ("box", (*size_m[:2], 0.0)) if piece.type == "plane" else (piece.type, size_m)


def _corners(piece: ObjectGeom) -> FloatArray:
    """Return the corners of the box around a piece, turned with it, shape (8, 3), [m]."""
    reach = extents([_shape(piece)])
    signs = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
    return signs * (reach.half_edges + reach.half_axes) @ matrix_from_quaternion(piece.quat).T + piece.pos_m


TO_INFANT = quaternion_from_matrix(matrix_from_euler((90.0, -90.0, 0.0)))
"""Orientation of a plane whose front looks along -x, its top up."""
BEFORE_M = 0.002  # Gap between a picture and the board behind it, so that this does not show through.
GLOWING: Rgba = (0.02, 0.02, 0.02, 1.0)
"""Colour of a picture that glows: it reflects so much of other light, and as much more shines as makes it white."""
FACETS = 16  # Facets along a side: MuJoCo computes light at their corners only.
CYCLE_PX, MAX_PX, ALONG_PX = 16, 8 * MAX_CYCLES, 8
"""Texels of a cycle, most of all cycles together, and texels along the stripes, where nothing changes."""


def show(
    name: str, spec: PicturedSpec, folder: Path, front_m: Vec3, *, glows: bool
) -> tuple[tuple[ObjectGeom, ...], Furniture]:
    """Return the picture of a piece of furniture, with its texture and material; nothing if it has none.

    Args:
        name: Of the furniture in the model.
        spec: What it shows; a path in it is relative to *folder*.
        folder: Folder of the spec.
        front_m: The middle of the front of the board behind it.
        glows: Whether it looks the same in every light.

    """
    half_m = cm_to_m(spec.width_cm) / 2, cm_to_m(spec.tall_cm) / 2
    if spec.grating:
        png = grating(spec.grating, spec.width_cm, spec.tall_cm)
    elif spec.picture:
        png = _read(folder / Path(spec.picture).expanduser())
    else:
        return (), BARE
    rgba, emission = (GLOWING, 1 / GLOWING[0]) if glows else (UNTINTED, 0.0)
    looks = WorldMaterial(f"{name}_picture", rgba, f"{name}_picture", specular=0.0, shininess=0.0, emission=emission)
    x, y, z = front_m
    size_m = (*half_m, 2 * max(half_m) / FACETS)
    plane = seen(piece(looks.name, "plane", size_m, (x - BEFORE_M, y, z), TO_INFANT, looks))
    return (plane,), Furniture((), (looks,), (WorldTexture(looks.name, f"assets/{looks.name}.png", png),))


def _read(path: Path) -> bytes:
    try:
        return read_picture_file(path)
    except TextureError as error:
        raise ObjectError("picture", str(error)) from None


def grating(spec: GratingSpec, width_cm: float, tall_cm: float) -> bytes:
    """Return the PNG of a grating over all of a picture, symmetric about its middle.

    Its brightness at a distance s from the middle, across the stripes, is (1 + c cos(2 pi s / l)) / 2, with contrast c
    and the length l of a cycle, which is one degree at the viewing distance over the spatial frequency.
    """
    is_vertical = spec.stripes == "vertical"
    cycles = (width_cm if is_vertical else tall_cm) / spec.cycle_cm
    count = int(min(MAX_PX, max(CYCLE_PX * np.ceil(cycles), CYCLE_PX)))
    places = (np.arange(count) + 0.5) / count - 0.5
    shades = 255 / 2 * (1 + spec.contrast * np.cos(2 * np.pi * cycles * places))
    stripes = np.broadcast_to(shades[None, :, None], (ALONG_PX, count, 3))
    return encode_png(stripes if is_vertical else stripes.swapaxes(0, 1))

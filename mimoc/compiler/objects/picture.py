"""Pictures on furniture: files of the user's, and gratings."""

from pathlib import Path

import numpy as np

from mimoc.base.errors import ObjectError, TextureError
from mimoc.base.geometry.rotations import Vec3, matrix_from_euler, quaternion_from_matrix
from mimoc.base.units import cm_to_m
from mimoc.compiler.looks.pictures import encode_png
from mimoc.compiler.looks.user_textures import read_picture_file
from mimoc.compiler.mjcf.furniture import BARE, UNTINTED, Furniture, Rgba, WorldMaterial, WorldTexture
from mimoc.compiler.mjcf.world import ObjectGeom
from mimoc.compiler.objects.boards import piece, seen
from mimoc.schema.object_furniture import MOST_CYCLES, GratingSpec, PicturedSpec

TO_INFANT = quaternion_from_matrix(matrix_from_euler((90.0, -90.0, 0.0)))
"""Of a plane whose front looks along -x, its top up."""
BEFORE_M = 0.002
"""Gap between a picture and the board behind it, so that this does not show through."""
GLOWING: Rgba = (0.02, 0.02, 0.02, 1.0)
"""Colour of a picture that glows: it reflects so much of other light, and as much more shines as makes it white."""
FACETS = 16
"""Along a side: MuJoCo computes light at their corners only."""
CYCLE_PX, MOST_PX, ALONG_PX = 16, 8 * MOST_CYCLES, 8
"""Texels of a cycle, most of all cycles together, and texels along the stripes, where nothing changes."""


def show(
    name: str, spec: PicturedSpec, folder: Path, front_m: Vec3, *, glows: bool
) -> tuple[tuple[ObjectGeom, ...], Furniture]:
    """Return the picture of a piece of furniture, with its texture and material; nothing if it has none.

    Args:
        name: Of the furniture in the model.
        spec: What it shows.
        folder: What its path is relative to.
        front_m: The middle of the front of the board behind it.
        glows: Whether it looks the same in every light.

    Raises:
        ObjectError: If the file cannot be read.
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
    count = int(min(MOST_PX, max(CYCLE_PX * np.ceil(cycles), CYCLE_PX)))
    places = (np.arange(count) + 0.5) / count - 0.5
    shades = 255 / 2 * (1 + spec.contrast * np.cos(2 * np.pi * cycles * places))
    stripes = np.broadcast_to(shades[None, :, None], (ALONG_PX, count, 3))
    return encode_png(stripes if is_vertical else stripes.swapaxes(0, 1))

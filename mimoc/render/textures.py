"""Textures that OpenGL takes in at little cost, for a single picture: those that are seen, with sides of 2^n pixels.

MuJoCo lets OpenGL halve each texture again and again. Without a graphics card, sides that are no powers of two need
programs of their own for that, whose compilation takes longer than drawing does.
"""

import mujoco
import numpy as np
import numpy.typing as npt
from PIL import Image

from mimoc.render.renderer import Setting

CUBE_SIDES = 6
FLAT = mujoco.mjtTexture.mjTEXTURE_2D
Bytes = npt.NDArray[np.uint8]


def lean_textures(model: mujoco.MjModel, colours: Bytes, used: npt.NDArray[np.bool_]) -> list[Setting]:
    """Return smaller textures, while OpenGL takes them: a pixel of those not *used*, shape (ntex,)."""
    pictures = [_picture(model, colours, number, bool(used[number])) for number in range(model.ntex)]
    sizes = np.array([picture.size for picture in pictures])
    if sizes.sum() > colours.size:  # There is no room for more than the model has.
        return [(model, "tex_data", colours)]
    packed = np.zeros_like(colours)
    packed[: sizes.sum()] = np.concatenate([picture.ravel() for picture in pictures])
    heights, widths = np.array([picture.shape[:2] for picture in pictures], np.int32).T
    starts = (np.cumsum(sizes) - sizes).astype(model.tex_adr.dtype)
    changed = {"tex_data": packed, "tex_adr": starts, "tex_height": heights, "tex_width": widths}
    return [(model, name, values) for name, values in changed.items()]


def _picture(model: mujoco.MjModel, colours: Bytes, number: int, is_used: bool) -> Bytes:
    """Return the pixels of a texture with sides of 2^n, the faces of a cube one below the other."""
    height, width, start = model.tex_height[number], model.tex_width[number], model.tex_adr[number]
    channels = model.tex_nchannel[number]
    sides = 1 if model.tex_type[number] == FLAT else CUBE_SIDES
    faces = colours[start : start + height * width * channels].reshape(sides, height // sides, width, channels)
    if not is_used:
        faces = faces[:, :1, :1]
    return np.concatenate([_enlarged(face) for face in faces])


def _enlarged(face: Bytes) -> Bytes:
    """Return a picture with sides that are the next powers of two, its colours between those of its pixels."""
    height, width = (1 << (side - 1).bit_length() for side in face.shape[:2])
    if (height, width) == face.shape[:2]:
        return face
    return np.asarray(Image.fromarray(face).resize((width, height), Image.Resampling.BILINEAR))

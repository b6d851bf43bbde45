"""What is behind infants, a plain background or walls that can be seen, and the textures that OpenGL takes."""

import mujoco
import numpy as np
import numpy.typing as npt
from PIL import Image

from mimoc.base.geometry.rotations import FloatArray
from mimoc.render.camera import Shot
from mimoc.render.opengl import set_fog
from mimoc.render.renderer import Setting
from mimoc.render.soft_light import Colour

BACKGROUND: Colour = (0.937, 0.928, 0.914)
FLOOR: tuple[Colour, Colour] = (1.0, 0.992, 0.976), (0.984, 0.976, 0.96)
"""Of the fields of the floor, before light falls on it: two that hardly differ (D)."""
FADES_WITHIN = 1.6
"""Over what distance the floor fades behind what is shown, as a share of that from the camera to there (D)."""
SKY, MAT = "sky", "mat"
"""Names of textures in `templates/scene.xml.j2`."""


def is_outdoors(model: mujoco.MjModel) -> bool:
    """Return whether no room is around the infants of a model: it has at most one plane, the floor."""
    return int((model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE).sum()) <= 1


def backdrop_colours(model: mujoco.MjModel) -> npt.NDArray[np.uint8]:
    """Return the colours of all textures of a model, as `tex_data` has them, floor and sky as in pictures."""
    colours = model.tex_data.copy()
    for name in (SKY, MAT):
        number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TEXTURE, name)
        if number >= 0:
            texture = model.texture(number)
            (start,), (width,), (height,), (channels,) = texture.adr, texture.width, texture.height, texture.nchannel
            pixels = colours[start : start + width * height * channels].reshape(-1, channels)
            pixels[:] = _of_byte(BACKGROUND) if name == SKY else _floor(pixels)
    return colours


def fade(shot: Shot, radius_m: float) -> None:
    """Let what is drawn from now on fade behind what is within a radius of the middle of a shot."""
    start_m = shot.depth_m + radius_m
    set_fog(start_m, (1 + FADES_WITHIN) * start_m)


def leave_out_walls(scene: mujoco.MjvScene, position_m: FloatArray) -> None:
    """Draw nothing of the planes of a scene that a camera is behind, whose position has the shape (3,).

    MuJoCo draws them over all that is in a room, with three tenths of their opacity: as a haze.
    """
    for geom in scene.geoms[: scene.ngeom]:
        if geom.type == mujoco.mjtGeom.mjGEOM_PLANE and (position_m - geom.pos) @ geom.mat[:, 2] < 0:
            geom.type = mujoco.mjtGeom.mjGEOM_NONE


def _floor(pixels: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    brightness = pixels.sum(axis=1, dtype=np.int64)
    return np.where((2 * brightness > brightness.min() + brightness.max())[:, None], *map(_of_byte, FLOOR))


def _of_byte(colour: Colour) -> npt.NDArray[np.uint8]:
    return np.rint(255 * np.array(colour)).astype(np.uint8)


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

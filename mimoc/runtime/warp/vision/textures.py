"""The textures of all infants as the ray caster reads them: one list of flat pictures for all worlds."""

from collections.abc import Sequence

import mujoco
import numpy as np
import numpy.typing as npt
import warp as wp

from mimoc.senses.sense import IntArray

Picture = npt.NDArray[np.uint8]
"""Shape (height, width, channels)."""

COLUMNS_PER_FACE = 4
"""How much wider a flat picture is than a face of its cube: four of them are around the equator."""
ROWS_PER_FACE = 2
CUBE = int(mujoco.mjtTexture.mjTEXTURE_CUBE)
CAPSULE = int(mujoco.mjtGeom.mjGEOM_CAPSULE)
SKY = int(mujoco.mjtTexture.mjTEXTURE_SKYBOX)


class Textures:
    """All different textures of some models, each once."""

    def __init__(self, models: Sequence[mujoco.MjModel]):
        """Gather them on Warp's present device."""
        self._places: dict[tuple[bytes, tuple[int, ...]], int] = {}
        self.registry: list[wp.Texture2D] = []
        """On the device, to be kept as long as they are used."""
        self.places = [[self._place(model, index) for index in range(model.ntex)] for model in models]
        """Where the textures of each model are in the list."""
        self.skies = [_sky(model, places) for model, places in zip(models, self.places, strict=True)]
        """Where the sky of each model is, -1 if it has none."""

    def of_materials(self, models: Sequence[mujoco.MjModel]) -> IntArray:
        """Return where the textures of each material are, -1 for none, shape (models, materials, roles)."""
        pairs = zip(models, self.places, strict=True)
        return np.stack([np.array([*places, -1])[model.mat_texid] for model, places in pairs])

    def _place(self, model: mujoco.MjModel, index: int) -> int:
        """Return where a texture of a model is in the list, to which it is added if it is new."""
        picture = _picture(model, index)
        if model.tex_type[index] == CUBE:
            picture = flat_picture(picture, _is_on_limbs(model, index))
        key = picture.tobytes(), picture.shape
        if key not in self._places:
            self._places[key] = len(self.registry)
            self.registry.append(_on_device(picture))
        return self._places[key]


def flat_picture(cube: Picture, on_limbs: bool) -> Picture:
    """Return a cube's texture by longitude and latitude, as the ray caster reads textures of whatever is round.

    Around limbs, that is capsules, it finds the longitude in the same way, but not the latitude: they get what is
    around the equator all along, which is right for stripes that run along them, as those of clothes do.

    Args:
        cube: The six faces from the top, in the order +x, -x, +y, -y, +z, -z, as OpenGL has them.
        on_limbs: Whether it is drawn around limbs.
    """
    size_px = cube.shape[1]
    columns, rows = COLUMNS_PER_FACE * size_px, ROWS_PER_FACE * size_px
    longitude = (np.arange(columns) + 0.5) / columns * 2 * np.pi
    latitude = (0.5 - (np.arange(rows) + 0.5) / rows)[:, None] * np.pi * (not on_limbs)
    x, y = np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude)
    z = np.broadcast_to(np.sin(latitude), x.shape)
    size = np.abs(np.stack([x, y, z]))
    axis = size.argmax(axis=0)
    positive = np.choose(axis, [x, y, z]) > 0
    along = np.choose(axis, [np.where(positive, -z, z), x, np.where(positive, x, -x)]) / size.max(axis=0)
    down = np.choose(axis, [-y, np.where(positive, z, -z), -y]) / size.max(axis=0)
    column, row = (np.minimum((share + 1) / 2 * size_px, size_px - 1).astype(int) for share in (along, down))
    return cube[(2 * axis + ~positive) * size_px + row, column]


def _picture(model: mujoco.MjModel, index: int) -> Picture:
    shape = int(model.tex_height[index]), int(model.tex_width[index]), int(model.tex_nchannel[index])
    start = int(model.tex_adr[index])
    return model.tex_data[start : start + int(np.prod(shape))].reshape(shape)


def _is_on_limbs(model: mujoco.MjModel, texture: int) -> bool:
    materials = np.flatnonzero((model.mat_texid == texture).any(axis=1))
    return bool((model.geom_type[np.isin(model.geom_matid, materials)] == CAPSULE).any())


def _sky(model: mujoco.MjModel, places: Sequence[int]) -> int:
    skies = np.flatnonzero(model.tex_type == SKY)
    return places[skies[0]] if len(skies) else -1


def _on_device(picture: Picture) -> wp.Texture2D:
    colours = np.ones((*picture.shape[:2], 4), np.float32)
    colours[..., : picture.shape[2]] = picture / np.float32(255)
    return wp.Texture2D(colours, filter_mode=wp.TextureFilterMode.LINEAR)

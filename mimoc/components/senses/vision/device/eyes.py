"""The cameras of all infants' eyes, drawn by MuJoCo Warp's ray caster, and the textures of all worlds in one list."""

import copy
from collections.abc import Sequence

import mujoco
import mujoco_warp as mjw
import numpy as np
import numpy.typing as npt
import warp as wp

from mimoc.base.mujoco_layout import SOLIDS_GROUP
from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.eyes import HIDDEN_GROUP
from mimoc.runtime.sense import IntArray

Picture = npt.NDArray[np.uint8]
"""Shape (height, width, channels)."""

COLUMNS_PER_FACE = 4
"""How much wider a flat picture is than a face of its cube: four of them are around the equator."""
ROWS_PER_FACE = 2
CUBE = int(mujoco.mjtTexture.mjTEXTURE_CUBE)
CAPSULE = int(mujoco.mjtGeom.mjGEOM_CAPSULE)
SKY = int(mujoco.mjtTexture.mjTEXTURE_SKYBOX)


def shared_textures(models: Sequence[mujoco.MjModel]) -> tuple[list[wp.Texture2D], list[IntArray]]:
    """Return the textures of some models, each once, on Warp's present device, and where those of each model are.

    Returns:
        The textures, to be kept as long as they are used; and for each model the place of each of its textures in the
        list, then -1, which is where MuJoCo's index for none leads.
    """
    places: dict[tuple[bytes, tuple[int, ...]], int] = {}
    registry: list[wp.Texture2D] = []
    tables = []
    for model in models:
        table = []
        for index in range(model.ntex):
            picture = _picture(model, index)
            key = picture.tobytes(), picture.shape
            if key not in places:
                places[key] = len(registry)
                registry.append(_on_device(picture))
            table.append(places[key])
        tables.append(np.array([*table, -1]))
    return registry, tables


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
    picture = model.tex_data[start : start + int(np.prod(shape))].reshape(shape)
    return flat_picture(picture, _is_on_limbs(model, index)) if model.tex_type[index] == CUBE else picture


def _is_on_limbs(model: mujoco.MjModel, texture: int) -> bool:
    materials = np.flatnonzero((model.mat_texid == texture).any(axis=1))
    return bool((model.geom_type[np.isin(model.geom_matid, materials)] == CAPSULE).any())


def _on_device(picture: Picture) -> wp.Texture2D:
    colours = np.ones((*picture.shape[:2], 4), np.float32)
    colours[..., : picture.shape[2]] = picture / np.float32(255)
    return wp.Texture2D(colours, filter_mode=wp.TextureFilterMode.LINEAR)


class Eyes:
    """What the eyes of all infants see, without shadows and reflections, as on the CPU."""

    def __init__(self, models: Sequence[mujoco.MjModel], entry: VisionEntry, body_of_world: IntArray, model: mjw.Model):
        """Set aside room for pictures of the same sizes, and put textures of all bodies on Warp's present device."""
        times, fovy_deg = entry.supersample, {float(fovy) for single in models for fovy in single.cam_fovy}
        self._context = mjw.create_render_context(
            _without(models[0], entry.unseen),
            len(body_of_world),
            cam_res=(times * entry.width_px, times * entry.height_px),
            cam_active=list(entry.cameras),
            render_rgb=True,
            render_depth=False,
            render_seg=False,
            render_skybox=True,
            use_precomputed_rays=len(fovy_deg) == 1,
        )
        self._shared, self._materials = model, None
        self._use_textures(models, body_of_world)

    def __call__(self, data: mjw.Data) -> wp.array:
        """Return packed colours, 0xAARRGGBB, of the pixels of one eye after the other, shape (worlds, pixels)."""
        model = copy.copy(self._shared)  # Its arrays are those of the worlds, but for the materials' textures.
        if self._materials is not None:
            model.mat_texid = self._materials
        mjw.refit_bvh(model, data, self._context)
        mjw.render(model, data, self._context)
        return self._context.rgb_data

    def _use_textures(self, models: Sequence[mujoco.MjModel], body_of_world: IntArray) -> None:
        """Let each world have the textures of its own infant."""
        registry, tables = shared_textures(models)
        skies = np.array(
            [
                table[next(iter(np.flatnonzero(model.tex_type == SKY)), -1)]
                for model, table in zip(models, tables, strict=True)
            ]
        )
        widths = np.array([1 if sky < 0 else registry[sky].width for sky in skies])
        self._context.textures, self._context.textures_registry = wp.array(registry, dtype=wp.Texture2D), registry
        self._context.skybox_tex_id = wp.array(skies[body_of_world], dtype=int)
        self._context.skybox_face_width = wp.array(widths[body_of_world], dtype=int)
        if registry:
            materials = np.stack([table[model.mat_texid] for model, table in zip(models, tables, strict=True)])
            self._materials = wp.array(materials[body_of_world], dtype=int)


def _without(model: mujoco.MjModel, bodies: Sequence[str]) -> mujoco.MjModel:
    """Return a copy of a model in which some bodies are not drawn."""
    shown = copy.copy(model)
    shown.geom_group[shown.geom_group == SOLIDS_GROUP] = 0  # Its ray caster draws no skins.
    hidden = [model.body(body).id for body in bodies]
    shown.geom_group[np.isin(model.geom_bodyid, hidden)] = HIDDEN_GROUP
    return shown

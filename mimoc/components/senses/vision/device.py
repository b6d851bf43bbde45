"""The sense of vision of all infants on a device: what the eyes draw, with the acuity and foveation of each."""

import copy
import functools
from collections.abc import Iterator, Sequence
from typing import Any

import mujoco
import mujoco_warp as mjw
import numpy as np
import numpy.typing as npt
import torch
import warp as wp
from gymnasium.spaces import Box

from mimoc.base.mujoco_layout import SOLIDS_GROUP
from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.eyes import HIDDEN_GROUP
from mimoc.components.senses.vision.filters import (
    Limits,
    contrast_gains,
    fade,
    filter_of,
    limit_colours,
    limits_of,
    noticed_share,
)
from mimoc.components.senses.vision.foveation import source_weights, visual_field
from mimoc.components.senses.vision.thresholds import Transform, cosine_matrix
from mimoc.render.renderer import average_down
from mimoc.runtime.device.arrays import put
from mimoc.runtime.device.signals import DeviceError, DeviceSetup
from mimoc.runtime.gymnasium_forms import mixture_error
from mimoc.runtime.sense import FloatArray, IntArray, Observation, Sample, Sense

# pyright: reportArgumentType=false, reportCallIssue=false, reportReturnType=false


class Filters:
    """From what eyes draw to what infants see, each with its own acuity and foveation."""

    def __init__(self, entries: Sequence[VisionEntry], fovy_deg: Sequence[float], body_of_world: IntArray):
        """Work out all that depends on sizes, which are the same of all bodies, and on ages, on the present device."""
        first, self._gain = entries[0], None
        self._times, self._eyes = first.supersample, len(first.cameras)
        self._size = first.height_px * first.supersample, first.width_px * first.supersample
        if any(entry.acuity_cpd is not None for entry in entries):
            eyes = self._eyes if any(entry.acuity_shares for entry in entries) else 1
            gains = np.stack([_gain(*self._size, *of_eyes, eyes) for of_eyes in zip(entries, fovy_deg, strict=True)])
            self._gain = put(gains[body_of_world][..., None])
            self._cosines = [put(cosine_matrix(size_px)) for size_px in self._size]
        self._field, self._noticed = (
            put(np.stack(shares)[body_of_world][:, None, :, :, None]) if min(map(np.min, shares)) < 1 else None
            for shares in zip(*map(self._fields, entries, fovy_deg), strict=True)
        )
        self._colours = list(self._limits(entries, fovy_deg, body_of_world))
        kinds = [(entry.foveation, entry.foveation_radius) for entry in entries]
        self._warps = [
            (put(np.flatnonzero([kinds[body] == kind for body in body_of_world])), _weights(first, *kind))
            for kind in dict.fromkeys(kinds)
            if kind[0]
        ]

    def __call__(self, drawn: wp.array) -> torch.Tensor:
        """Return rounded colours of one eye after the other from what `Eyes` returns, shape (worlds, n), 8 bits."""
        packed = wp.to_torch(drawn.view(wp.int32))
        colours = torch.stack([(packed >> shift) & 255 for shift in (16, 8, 0)], dim=-1)
        pictures = colours.float().reshape(-1, self._eyes, *self._size, len("rgb"))
        if self._gain is not None:  # The cosine transform of `blur`, as products, for torch has none.
            spectrum = torch.einsum("rh,cw,kehwx->kercx", *self._cosines, pictures) * self._gain
            pictures = torch.einsum("rh,cw,kercx->kehwx", *self._cosines, spectrum)
        for worlds, limits in self._colours:
            pictures[worlds] = limit_colours(pictures[worlds], limits, TORCH)
        if self._field is not None:
            pictures = pictures * self._field
        if self._noticed is not None:
            pictures = fade(pictures, self._noticed)
        pictures = average_down(pictures, self._times)
        for worlds, weights in self._warps:
            planes = pictures[worlds].permute(2, 3, 0, 1, 4)
            warped = torch.sparse.mm(weights, planes.reshape(weights.shape[1], -1)).reshape(planes.shape)
            pictures[worlds] = warped.permute(2, 3, 0, 1, 4)
        return pictures.clamp(0, 255).round().to(torch.uint8).reshape(len(pictures), -1)

    def _fields(self, entry: VisionEntry, fovy_deg: float) -> tuple[FloatArray, FloatArray]:
        """Return where an infant sees, and how much it notices, shape (height, width) each."""
        size = *self._size[::-1], fovy_deg
        noticed = np.ones(self._size) if entry.noticed_deg is None else noticed_share(*size, entry.noticed_deg)
        return visual_field(*size, entry.field_deg), noticed

    def _limits(
        self, entries: Sequence[VisionEntry], fovy_deg: Sequence[float], body_of_world: IntArray
    ) -> Iterator[tuple[torch.Tensor, Limits]]:
        """Yield the worlds of each body whose luminance is limited apart from chroma, with what limits it."""
        for body, (entry, at_deg) in enumerate(zip(entries, fovy_deg, strict=True)):
            if (limits := limits_of(entry, self._size[::-1], at_deg)) is not None:
                yield put(np.flatnonzero(body_of_world == body)), limits.mapped(put)


@functools.lru_cache(maxsize=64)
def _cosines(size: int, device: torch.device) -> torch.Tensor:
    return torch.tensor(cosine_matrix(size), dtype=torch.float32, device=device)


def _forward(planes: torch.Tensor) -> torch.Tensor:
    rows, columns = (_cosines(size, planes.device) for size in planes.shape[-2:])
    return rows @ planes @ columns.mT


def _inverse(spectrum: torch.Tensor) -> torch.Tensor:
    rows, columns = (_cosines(size, spectrum.device) for size in spectrum.shape[-2:])
    return rows.mT @ spectrum @ columns


TORCH = Transform(_forward, _inverse, torch)  # The cosine transform by torch, which has none, as products.


def _gain(height_px: int, width_px: int, entry: VisionEntry, fovy_deg: float, eyes: int) -> FloatArray:
    """Return how much contrast is left of each cosine, shape (eyes, height, width), of one for both if they are equal.

    That is all of it where acuity is not limited, or limits luminance apart from chroma.
    """
    shares = entry.acuity_shares or (1.0,) * eyes
    size = (width_px, height_px)
    gains = None if limits_of(entry, size, fovy_deg) else contrast_gains(entry, size, fovy_deg, shares)
    return np.ones((len(shares), height_px, width_px)) if gains is None else np.array(gains, float, ndmin=3)


def _weights(entry: VisionEntry, strength: float, radius: str) -> torch.Tensor:
    weights = source_weights(entry.width_px, entry.height_px, strength, radius).tocoo()
    places = np.stack([weights.row, weights.col]).astype(np.int64)
    device = wp.device_to_torch(wp.get_device())
    with torch.sparse.check_sparse_tensor_invariants():  # Torch warns of whoever does not say whether to check.
        matrix = torch.sparse_coo_tensor(torch.as_tensor(places), torch.as_tensor(weights.data), weights.shape)
        return matrix.coalesce().to(device)


SHARED = ("cameras", "width_px", "height_px", "supersample", "unseen")  # What must be the same of all infants' vision.


class VisionReader:
    """What all infants see."""

    def __init__(self, setup: DeviceSetup):
        """Open the eyes.

        Raises:
            BatchMismatchError: If their eyes have pictures of different sizes.
            DeviceError: If they are out of focus, which takes distances that are not drawn here, or are to see skins.
        """
        entries: list[Any] = [infant.manifest.senses.vision for infant in setup.infants]
        _check(entries)
        first: VisionEntry = entries[0]
        models = [infant.model for infant in setup.infants]
        fovy_deg = [float(model.cam_fovy[model.camera(first.cameras[0]).id]) for model in models]
        self._eyes = Eyes(models, first, setup.body.cpu().numpy(), setup.model)
        self._filters = Filters(entries, fovy_deg, setup.body.cpu().numpy())

    def __call__(self, data: mjw.Data) -> torch.Tensor:
        """Return what is seen now, without delay, shape (worlds, n), in 8 bits."""
        return self._filters(self._eyes(data))


bind = VisionReader


class NoVision(Sense):
    """The vision of a single environment which only draws starts: it needs no OpenGL and sees nothing."""

    @property
    def layout(self) -> tuple[str, ...]:
        """What the axes of each picture are."""
        return tuple(f"{name} row, column, red green blue [0-255]" for name in self.spaces)

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return black pictures."""
        return np.zeros([len(self.spaces), *next(iter(self.spaces.values())).shape], np.uint8)

    def observe(self, sample: Sample) -> Observation:
        """Return the pictures by the names of their cameras."""
        return {name: picture.copy() for name, picture in zip(self.spaces, sample, strict=True)}

    def rebind(self, entry: VisionEntry | None, model: mujoco.MjModel) -> bool:
        """Take the place of an infant's vision, if it has any."""
        if entry is None:
            return False
        shape = entry.height_px, entry.width_px, 3
        self.spaces = {name: Box(0, 255, shape, np.uint8) for name in entry.cameras}
        self.filter = filter_of(entry)
        ids = [model.camera(name).id for name in entry.cameras]
        self.bodies = model.cam_bodyid[ids].astype(np.intp)
        return True


def _check(entries: Sequence[VisionEntry]) -> None:
    for number, entry in enumerate(entries):
        if entry.unfocused:
            raise DeviceError(
                f"infant {number}: eyes that are out of focus ('senses.vision.focus') do not run on a device; leave it "
                "out, or leave out device"
            )
        if entry.body == "skin":
            raise DeviceError(
                f"infant {number}: MuJoCo Warp draws no skins, so eyes see solids on a device; leave out "
                "'senses.vision.body', or leave out device"
            )
        for name in SHARED:
            ours, theirs = getattr(entries[0], name), getattr(entry, name)
            if ours != theirs:
                raise mixture_error(f"0 and {number}", f"vision.{name} ({ours}, {theirs})")


Picture = npt.NDArray[np.uint8]  # Shape (height, width, channels).

COLUMNS_PER_FACE = 4  # How much wider a flat picture is than a face of its cube: four of them are around the equator.
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
            shape = int(model.tex_height[index]), int(model.tex_width[index]), int(model.tex_nchannel[index])
            start = int(model.tex_adr[index])
            picture = model.tex_data[start : start + int(np.prod(shape))].reshape(shape)
            picture = flat_picture(picture, _is_on_limbs(model, index)) if model.tex_type[index] == CUBE else picture
            key = picture.tobytes(), picture.shape
            if key not in places:
                places[key] = len(registry)
                colours = np.ones((*picture.shape[:2], 4), np.float32)
                colours[..., : picture.shape[2]] = picture / np.float32(255)
                registry.append(wp.Texture2D(colours, filter_mode=wp.TextureFilterMode.LINEAR))
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


def _is_on_limbs(model: mujoco.MjModel, texture: int) -> bool:
    materials = np.flatnonzero((model.mat_texid == texture).any(axis=1))
    return bool((model.geom_type[np.isin(model.geom_matid, materials)] == CAPSULE).any())


class Eyes:
    """What the eyes of all infants see, without shadows and reflections, as on the CPU."""

    def __init__(self, models: Sequence[mujoco.MjModel], entry: VisionEntry, body_of_world: IntArray, model: mjw.Model):
        """Set aside room for pictures of the same sizes, and put textures of all bodies on Warp's present device."""
        times = entry.supersample
        fovy_deg = {float(fovy) for single in models for fovy in single.cam_fovy}
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
        registry, tables = shared_textures(models)
        skies = np.array(
            [
                table[next(iter(np.flatnonzero(model.tex_type == SKY)), -1)]
                for model, table in zip(models, tables, strict=True)
            ]
        )
        widths = np.array([1 if sky < 0 else registry[sky].width for sky in skies])
        self._context.textures = wp.array(registry, dtype=wp.Texture2D)
        self._context.textures_registry = registry
        self._context.skybox_tex_id = wp.array(skies[body_of_world], dtype=int)
        self._context.skybox_face_width = wp.array(widths[body_of_world], dtype=int)
        if registry:
            materials = np.stack([table[model.mat_texid] for model, table in zip(models, tables, strict=True)])
            self._materials = wp.array(materials[body_of_world], dtype=int)

    def __call__(self, data: mjw.Data) -> wp.array:
        """Return packed colours, 0xAARRGGBB, of the pixels of one eye after the other, shape (worlds, pixels)."""
        model = copy.copy(self._shared)  # Its arrays are those of the worlds, but for the materials' textures.
        if self._materials is not None:
            model.mat_texid = self._materials
        mjw.refit_bvh(model, data, self._context)
        mjw.render(model, data, self._context)
        return self._context.rgb_data


def _without(model: mujoco.MjModel, bodies: Sequence[str]) -> mujoco.MjModel:
    shown = copy.copy(model)
    shown.geom_group[shown.geom_group == SOLIDS_GROUP] = 0  # Its ray caster draws no skins.
    hidden = [model.body(body).id for body in bodies]
    shown.geom_group[np.isin(model.geom_bodyid, hidden)] = HIDDEN_GROUP
    return shown

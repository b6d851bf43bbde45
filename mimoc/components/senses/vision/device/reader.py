"""The sense of vision of all infants on a device: what the eyes draw, with the acuity and foveation of each."""

# pyright: reportArgumentType=false, reportCallIssue=false, reportReturnType=false

import functools
from collections.abc import Iterator, Sequence
from typing import Any

import mujoco
import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.spaces import Box

from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.colours import Limits, limit_colours, limits_of
from mimoc.components.senses.vision.device.eyes import Eyes
from mimoc.components.senses.vision.flicker import filter_of
from mimoc.components.senses.vision.foveation import contrast_gain, source_weights, visual_field
from mimoc.components.senses.vision.noticing import fade, noticed_share
from mimoc.components.senses.vision.thresholds import Transform, cosine_matrix
from mimoc.render.renderer import average_down
from mimoc.runtime.batch.gymnasium_forms import mixture_error
from mimoc.runtime.device.arrays import put
from mimoc.runtime.device.signals import DeviceError, DeviceSetup
from mimoc.runtime.sense import FloatArray, IntArray, Observation, Sample, Sense


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


TORCH = Transform(_forward, _inverse, torch)
"""The cosine transform by torch, which has none, as products."""


def _gain(height_px: int, width_px: int, entry: VisionEntry, fovy_deg: float, eyes: int) -> FloatArray:
    """Return how much contrast is left of each cosine, shape (eyes, height, width), of one for both if they are equal.

    That is all of it where acuity is not limited, or limits luminance apart from chroma.
    """
    shares = entry.acuity_shares or (1.0,) * eyes
    size = width_px, height_px, fovy_deg
    if entry.acuity_cpd is None or limits_of(entry, (width_px, height_px), fovy_deg) is not None:
        return np.ones((len(shares), height_px, width_px))
    return np.stack([contrast_gain(*size, share * entry.acuity_cpd, entry.contrast) for share in shares]).astype(float)


def _weights(entry: VisionEntry, strength: float, radius: str) -> torch.Tensor:
    """Return what each pixel that is seen averages of the picture as it was drawn, shape (pixels, pixels), sparse."""
    weights = source_weights(entry.width_px, entry.height_px, strength, radius).tocoo()
    places, device = np.stack([weights.row, weights.col]).astype(np.int64), wp.device_to_torch(wp.get_device())
    with torch.sparse.check_sparse_tensor_invariants():  # Torch warns of whoever does not say whether to check.
        matrix = torch.sparse_coo_tensor(torch.as_tensor(places), torch.as_tensor(weights.data), weights.shape)
        return matrix.coalesce().to(device)


SHARED = ("cameras", "width_px", "height_px", "supersample", "unseen")
"""What must be the same of all infants' vision."""


class VisionReader:
    """What all infants see."""

    def __init__(self, setup: DeviceSetup):
        """Open the eyes.

        Raises:
            MixtureError: If their eyes have pictures of different sizes.
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

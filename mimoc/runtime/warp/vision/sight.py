"""The sense of vision of all infants on a device, from rays to observations."""

from collections.abc import Sequence
from typing import Any

import mujoco
import mujoco_warp as mjw
import numpy as np
import warp as wp
from gymnasium.spaces import Box

from mimoc.runtime.many.matching import MixtureError
from mimoc.runtime.warp.signals import DeviceSetup
from mimoc.runtime.warp.vision.eyes import Eyes
from mimoc.runtime.warp.vision.filters import Filters
from mimoc.senses.sense import Observation, Sample, Sense
from mimoc.senses.vision.spec import VisionEntry

VISION = "vision"
SHARED = ("cameras", "width_px", "height_px", "supersample", "unseen")
"""What must be the same of all infants' vision."""


class Sight:
    """What all infants see."""

    def __init__(self, setup: DeviceSetup):
        """Open the eyes.

        Raises:
            MixtureError: If their eyes have pictures of different sizes.
        """
        entries: list[Any] = [infant.manifest.senses.vision for infant in setup.infants]
        _check(entries)
        first: VisionEntry = entries[0]
        models = [infant.model for infant in setup.infants]
        fovy_deg = [float(model.cam_fovy[model.camera(first.cameras[0]).id]) for model in models]
        self._model, self._eyes = setup.model, Eyes(models, first, setup.body.numpy(), setup.model)
        self._filters = Filters(entries, fovy_deg, setup.body.numpy())
        self._shape = setup.body.shape[0], len(first.cameras) * first.height_px * first.width_px * len("rgb")

    def __call__(self, model: mjw.Model, data: mjw.Data, sample: wp.array) -> None:
        """Write what is seen now, shape (worlds, n), in 8 bits."""
        wp.to_torch(sample).copy_(self._filters(self._eyes(data)))

    def look(self, data: mjw.Data) -> wp.array:
        """Return what is seen now, without delay, shape (worlds, n)."""
        pictures = wp.empty(self._shape, dtype=wp.uint8)
        self(self._model, data, pictures)
        return pictures


bind = Sight


class ClosedEyes(Sense):
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

    def follow(self, entry: VisionEntry | None, model: mujoco.MjModel) -> bool:
        """Take the place of an infant's vision, if it has any."""
        if entry is None:
            return False
        shape = entry.height_px, entry.width_px, 3
        self.spaces = {name: Box(0, 255, shape, np.uint8) for name in entry.cameras}
        ids = [model.camera(name).id for name in entry.cameras]
        self.bodies = model.cam_bodyid[ids].astype(np.intp)
        return True


def _check(entries: Sequence[VisionEntry]) -> None:
    for name in SHARED:
        values = [getattr(entry, name) for entry in entries]
        for number, value in enumerate(values):
            if value != values[0]:
                raise MixtureError(
                    f"infants 0 and {number} cannot share a batch, because they differ in vision.{name} "
                    f"({values[0]}, {value}); make a vector environment of each kind"
                )

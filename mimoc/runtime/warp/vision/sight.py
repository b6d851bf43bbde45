"""The sense of vision of all infants on a device, from rays to observations."""

from collections.abc import Mapping, Sequence
from typing import Any

import mujoco
import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.spaces import Box

from mimoc.bundle.manifest import Manifest
from mimoc.runtime.many.matching import MixtureError
from mimoc.runtime.warp.lines import Ring, delay_steps
from mimoc.runtime.warp.vision.eyes import Eyes
from mimoc.runtime.warp.vision.filters import Filters
from mimoc.senses.sense import IntArray, Observation, Sample, Sense
from mimoc.senses.vision.spec import VisionEntry

VISION = "vision"
SHARED = ("cameras", "width_px", "height_px", "supersample", "unseen")
"""What must be the same of all infants' vision."""


class PictureLine(Ring):
    """The pictures of all infants on their way, in 8 bits, with one delay for all that an infant sees."""

    def arrive(self, clock: wp.array, pictures: Sequence[wp.array]) -> None:
        """Write what has arrived to an array of each eye, shape (worlds, height, width, 3)."""
        lengths, ring = wp.to_torch(self._length)[wp.to_torch(self._body).long(), 0], wp.to_torch(self._ring)
        slots = (wp.to_torch(clock) + 1) % (lengths + 1)
        arrived = ring[slots.long(), torch.arange(len(slots), device=slots.device)]
        for picture, part in zip(pictures, arrived.chunk(len(pictures), dim=1), strict=True):
            wp.to_torch(picture).copy_(part.reshape(picture.shape))


class Sight:
    """What all infants see."""

    def __init__(
        self,
        manifests: Sequence[Manifest],
        models: Sequence[mujoco.MjModel],
        body_of_world: IntArray,
        body: wp.array,
        model: mjw.Model,
        period: int,
    ):
        """Open the eyes.

        Args:
            manifests: Of the different bodies.
            models: Of these.
            body_of_world: Which of them lives in each world, shape (worlds,).
            body: The same, on the device.
            model: That of all worlds.
            period: Physics steps in a control step.

        Raises:
            MixtureError: If their eyes have pictures of different sizes.
        """
        entries: list[Any] = [manifest.senses.vision for manifest in manifests]
        _check(entries)
        first: VisionEntry = entries[0]
        self._cameras = first.cameras
        fovy_deg = [float(each.cam_fovy[each.camera(first.cameras[0]).id]) for each in models]
        self._eyes = Eyes(models, first, body_of_world, model)
        self._filters = Filters(entries, fovy_deg, body_of_world)
        delays = np.stack([delay_steps(manifest, VISION, None, 1) for manifest in manifests])
        numbers = len(first.cameras) * first.height_px * first.width_px * len("rgb")
        self._line, self._period = PictureLine(delays, period, body, numbers, wp.uint8), period

    def sample(self, model: mjw.Model, data: mjw.Data, clock: wp.array, rest: int) -> None:
        """Look, if what is seen now arrives *rest* physics steps less than whole control steps later."""
        if (self._line.delays % self._period == rest).any():
            self.look(data)
            self._line.send(clock, rest)

    def look(self, data: mjw.Data) -> wp.array:
        """Return what is seen now, without delay, shape (worlds, n)."""
        wp.to_torch(self._line.entering).copy_(self._filters(self._eyes(data)))
        return self._line.entering

    def arrive(self, clock: wp.array, observation: Mapping[str, wp.array]) -> None:
        """Write what has arrived to the pictures of each eye."""
        self._line.arrive(clock, [observation[camera] for camera in self._cameras])

    def refill(self, chosen: wp.array, samples: Mapping[str, wp.array]) -> None:
        """See from now on what is seen at the starts of worlds that begin anew."""
        self._line.refill(chosen, samples[VISION])


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

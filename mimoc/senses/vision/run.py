"""Sight: what the eyes' cameras draw, as fine as an infant's eyes see it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import mujoco
import numpy as np
from gymnasium.spaces import Box

from mimoc.bundle.io import Bundle
from mimoc.render.averaging import average_down
from mimoc.senses.sense import IntArray, Observation, Reading
from mimoc.senses.vision.blur import blur, contrast_gain
from mimoc.senses.vision.eyes import Drawn, Eyes
from mimoc.senses.vision.foveation import Pictures, foveate, source_weights
from mimoc.senses.vision.spec import VisionEntry

Filter = Callable[[Pictures], Pictures]
"""From pictures to pictures, shape (..., height, width, colours), 0 to 255."""


@dataclass(frozen=True)
class Vision:
    """Pictures of both eyes, or of the one there is, shape (eyes, height, width, 3)."""

    cameras: tuple[str, ...]
    bodies: IntArray
    """The body of each eye."""
    eyes: Eyes
    filters: tuple[Filter, ...]
    """What happens to what is drawn, in this order."""
    width_px: int
    height_px: int

    @property
    def spaces(self) -> Mapping[str, Box]:
        """The space of each picture, under the name of its camera."""
        return {name: Box(0, 255, (self.height_px, self.width_px, 3), np.uint8) for name in self.cameras}

    @property
    def layout(self) -> tuple[str, ...]:
        """What the axes of each picture are, rows from the top; one entry an eye."""
        return tuple(f"{name} row, column, red green blue [0-255]" for name in self.cameras)

    def __call__(self, data: mujoco.MjData) -> Reading:
        """Return what is seen now."""
        return perceive(self.eyes(data), self.filters)

    def observe(self, reading: Reading) -> Observation:
        """Return a picture for each eye."""
        return {name: picture.copy() for name, picture in zip(self.cameras, reading, strict=True)}

    def follow(self, model: mujoco.MjModel) -> bool:
        """See another scene, with the same eyes."""
        self.eyes.turn_to(model)
        return True

    def close(self) -> None:
        """Free the OpenGL context."""
        self.eyes.close()


def bind(entry: VisionEntry, model: mujoco.MjModel, bundle: Bundle) -> Vision:
    """Open the eyes of *entry* in *model*.

    Raises:
        RenderingError: If there is no OpenGL here, or none that draws such large pictures.
    """
    larger = entry.supersample
    ids = [model.camera(name).id for name in entry.cameras]
    return Vision(
        cameras=entry.cameras,
        bodies=model.cam_bodyid[ids].astype(np.intp),
        eyes=Eyes(model, entry.cameras, larger * entry.width_px, larger * entry.height_px, entry.unseen),
        filters=filters(entry, float(model.cam_fovy[ids[0]])),
        width_px=entry.width_px,
        height_px=entry.height_px,
    )


def filters(entry: VisionEntry, fovy_deg: float) -> tuple[Filter, ...]:
    """Return what makes of what is drawn what is seen: blur at the size drawn, average down, then warp.

    Args:
        entry: What the eyes see.
        fovy_deg: Vertical field of view of their cameras.
    """
    found: list[Filter] = []
    if entry.acuity_cpd is not None:
        drawn = entry.width_px * entry.supersample, entry.height_px * entry.supersample
        found.append(partial(blur, gain=contrast_gain(*drawn, fovy_deg, entry.acuity_cpd)))
    if entry.supersample > 1:
        found.append(partial(average_down, times=entry.supersample))
    if entry.foveation:
        size = entry.width_px, entry.height_px
        found.append(partial(foveate, sources=source_weights(*size, entry.foveation, entry.foveation_radius)))
    return tuple(found)


def perceive(drawn: Drawn, filters: Sequence[Filter]) -> Drawn:
    """Return pictures after all filters, which together round but once."""
    if not filters:
        return drawn.copy()
    seen = drawn.astype(np.float32)
    for apply in filters:
        seen = apply(seen)
    return np.rint(seen.clip(0, 255)).astype(np.uint8)

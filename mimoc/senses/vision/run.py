"""Vision: what the cameras of the eyes draw, with the acuity and foveation of the infant."""

from collections.abc import Callable, Sequence
from functools import partial

import mujoco
import numpy as np
from gymnasium.spaces import Box

from mimoc.bundle.io import Bundle
from mimoc.render.renderer import average_down
from mimoc.senses.sense import IntArray, Observation, Sample, Sense
from mimoc.senses.vision import VisionEntry
from mimoc.senses.vision.eyes import Drawn, Eyes
from mimoc.senses.vision.foveation import Pictures, blur, contrast_gain, foveate, source_weights, visual_field

Filter = Callable[[Pictures], Pictures]
"""From pictures to pictures, shape (..., height, width, colours), 0 to 255."""


class Vision(Sense):
    """Pictures of both eyes, or of the one there is, shape (eyes, height, width, 3)."""

    def __init__(
        self,
        eyes: Eyes,
        filters: Sequence[Filter],
        entry: VisionEntry,
        bodies: IntArray,
        names: Sequence[str] | None = None,
    ):
        """See with some eyes, each on a body, shape (eyes,); filters are applied in order to what they draw.

        Pictures have the *names* of the cameras by default.
        """
        self._names = tuple(names or entry.cameras)
        self.eyes, self.filters, self.bodies, self._entry = eyes, tuple(filters), bodies, entry
        self.reads_in_threads = eyes.shares
        shape = (entry.height_px, entry.width_px, 3)
        self.spaces = {name: Box(0, 255, shape, np.uint8) for name in self._names}

    @property
    def layout(self) -> tuple[str, ...]:
        """What the axes of each picture are, rows from the top; one entry for each eye."""
        return tuple(f"{name} row, column, red green blue [0-255]" for name in self._names)

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return the pictures of now."""
        return perceive(self.eyes(data), self.filters)

    def observe(self, sample: Sample) -> Observation:
        """Return a picture for each eye, under the name of its camera."""
        return {name: picture.copy() for name, picture in zip(self._names, sample, strict=True)}

    def rebind(self, entry: VisionEntry, model: mujoco.MjModel) -> bool:
        """See another scene, or with the acuity of another age, with the same OpenGL context."""
        self.eyes.use_model(model)
        if entry != self._entry:
            self._entry, self.filters = entry, filters(entry, self.eyes.fovy_deg)
        return True

    def close(self) -> None:
        """Free the OpenGL context."""
        self.eyes.close()


def bind(entry: VisionEntry, model: mujoco.MjModel, bundle: Bundle) -> Vision:
    """Open the eyes of *entry* in *model*.

    Raises:
        RenderingError: If there is no OpenGL here, or none that draws such large pictures.
    """
    times = entry.supersample
    ids = [model.camera(name).id for name in entry.cameras]
    eyes = Eyes(model, entry.cameras, times * entry.width_px, times * entry.height_px, entry.unseen, entry.body)
    names = [bundle.manifest.of_infant(name) for name in entry.cameras]
    return Vision(eyes, filters(entry, eyes.fovy_deg), entry, model.cam_bodyid[ids].astype(np.intp), names)


def filters(entry: VisionEntry, fovy_deg: float) -> tuple[Filter, ...]:
    """Return the filters between drawing and observation: blur at the size drawn, average down, then warp."""
    chain: list[Filter] = []
    drawn = entry.width_px * entry.supersample, entry.height_px * entry.supersample
    if entry.acuity_cpd is not None:
        gains = [
            contrast_gain(*drawn, fovy_deg, share * entry.acuity_cpd, entry.contrast)
            for share in entry.acuity_shares or (1.0,)
        ]
        chain.append(partial(blur, gain=np.stack(gains) if len(gains) > 1 else gains[0]))
    if entry.field_deg:
        chain.append(partial(np.multiply, visual_field(*drawn, fovy_deg, entry.field_deg)[..., None]))
    if entry.supersample > 1:
        chain.append(partial(average_down, times=entry.supersample))
    if entry.foveation:
        size = entry.width_px, entry.height_px
        chain.append(partial(foveate, sources=source_weights(*size, entry.foveation, entry.foveation_radius)))
    return tuple(chain)


def perceive(drawn: Drawn, filters: Sequence[Filter]) -> Drawn:
    """Return pictures after all filters, rounded once at the end."""
    if not filters:
        return drawn.copy()
    seen = drawn.astype(np.float32)
    for apply in filters:
        seen = apply(seen)
    return np.rint(seen.clip(0, 255)).astype(np.uint8)

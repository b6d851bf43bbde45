"""Vision: what the cameras of the eyes draw, with the acuity and foveation of the infant."""

from collections.abc import Callable, Sequence
from functools import partial

import mujoco
import numpy as np
from gymnasium.spaces import Box

from mimoc.bundle.io import Bundle
from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.eyes import Drawn, Eyes, View
from mimoc.components.senses.vision.filters import (
    Lens,
    contrast_gains,
    defocus,
    fade,
    filter_of,
    limit_colours,
    limits_of,
    noticed_share,
)
from mimoc.components.senses.vision.foveation import Pictures, blur, foveate, source_weights, visual_field
from mimoc.components.senses.vision.thresholds import COSINES
from mimoc.render.renderer import average_down
from mimoc.runtime.sense import IntArray, Observation, Sample, Sense

Filter = Callable[[Pictures], Pictures]  # From pictures to pictures, shape (..., height, width, colours), 0 to 255.


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
        self.eyes = eyes
        self.filters = tuple(filters)
        self.bodies = bodies
        self._entry = entry
        self._lens, self.filter = lens_of(entry), filter_of(entry)
        self.reads_in_threads = eyes.shares
        shape = (entry.height_px, entry.width_px, 3)
        self.spaces = {name: Box(0, 255, shape, np.uint8) for name in self._names}

    @property
    def layout(self) -> tuple[str, ...]:
        """What the axes of each picture are, rows from the top; one entry for each eye."""
        return tuple(f"{name} row, column, red green blue [0-255]" for name in self._names)

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return the pictures of now."""
        if self._lens is None:
            return perceive(self.eyes(data), self.filters)
        return perceive_in_focus(self.eyes.view(data), self._lens, self.eyes.fovy_deg, self.filters)

    def observe(self, sample: Sample) -> Observation:
        """Return a picture for each eye, under the name of its camera."""
        return {name: picture.copy() for name, picture in zip(self._names, sample, strict=True)}

    def rebind(self, entry: VisionEntry, model: mujoco.MjModel) -> bool:
        """See another scene, or with the acuity of another age, with the same OpenGL context."""
        self.eyes.use_model(model)
        if entry != self._entry:
            self._entry, self.filters = entry, filters(entry, self.eyes.fovy_deg)
            self._lens, self.filter = lens_of(entry), filter_of(entry)
        return True

    def close(self) -> None:
        """Free the OpenGL context."""
        self.eyes.close()


def bind(entry: VisionEntry, model: mujoco.MjModel, bundle: Bundle) -> Vision:
    """Open the eyes of *entry* in *model*.

    Raises:
        RenderingError: If there is no OpenGL here, or none that draws such large pictures.
    """
    times, shown = entry.supersample, entry.body or "skin"
    ids = [model.camera(name).id for name in entry.cameras]
    eyes = Eyes(model, entry.cameras, times * entry.width_px, times * entry.height_px, entry.unseen, shown)
    names = [bundle.manifest.of_infant(name) for name in entry.cameras]
    return Vision(eyes, filters(entry, eyes.fovy_deg), entry, model.cam_bodyid[ids].astype(np.intp), names)


def filters(entry: VisionEntry, fovy_deg: float) -> tuple[Filter, ...]:
    """Return the filters between drawing and observation, but for focus.

    At the size drawn: acuity, contrast and colour, then the field; then pictures are averaged down, and warped last.
    """
    chain: list[Filter] = []
    drawn = entry.width_px * entry.supersample, entry.height_px * entry.supersample
    if (limits := limits_of(entry, drawn, fovy_deg)) is not None:
        chain.append(partial(limit_colours, limits=limits, transform=COSINES))
    elif (gain := contrast_gains(entry, drawn, fovy_deg, entry.acuity_shares or (1.0,))) is not None:
        chain.append(partial(blur, gain=gain))
    if entry.field_deg:
        chain.append(partial(np.multiply, visual_field(*drawn, fovy_deg, entry.field_deg)[..., None]))
    if entry.noticed_deg is not None:
        share = noticed_share(*drawn, fovy_deg, entry.noticed_deg)
        if share.min() < 1:
            chain.append(partial(fade, share=np.repeat(share[..., None], 3, axis=-1)))  # Three times as fast as one.
    if entry.supersample > 1:
        chain.append(partial(average_down, times=entry.supersample))
    if entry.foveation:
        size = entry.width_px, entry.height_px
        chain.append(partial(foveate, sources=source_weights(*size, entry.foveation, entry.foveation_radius)))
    return tuple(chain)


def lens_of(entry: VisionEntry) -> Lens | None:
    """Return an eye's focus; None if it sees all distances sharply."""
    return Lens(entry.unfocused, entry.focus_depth_dioptres) if entry.unfocused else None


def perceive_view(view: View, entry: VisionEntry, fovy_deg: float) -> Drawn:
    """Return what an infant with an entry sees of what is drawn with a vertical field of view."""
    lens, ways = lens_of(entry), filters(entry, fovy_deg)
    return perceive(view.drawn, ways) if lens is None else perceive_in_focus(view, lens, fovy_deg, ways)


def perceive(drawn: Drawn, filters: Sequence[Filter]) -> Drawn:
    """Return pictures after all filters, rounded once at the end."""
    if not filters:
        return drawn.copy()
    return _perceived(drawn.astype(np.float32), filters)


def perceive_in_focus(view: View, lens: Lens, fovy_deg: float, filters: Sequence[Filter]) -> Drawn:
    """Return pictures after all filters, of which the first is the focus of the eyes."""
    return _perceived(defocus(view.drawn.astype(np.float32), view.distances_m, lens, fovy_deg), filters)


def _perceived(seen: Pictures, filters: Sequence[Filter]) -> Drawn:
    for apply in filters:
        seen = apply(seen)
    return np.rint(seen.clip(0, 255)).astype(np.uint8)

"""Contrast of gratings after the filter of an infant's eye."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.senses.vision.foveation import pixels_per_degree
from mimoc.senses.vision.run import filters, perceive
from mimoc.senses.vision.spec import VisionEntry, VisionSpec

WIDTH_PX, HEIGHT_PX = 8, 2048
"""Size of an image of horizontal bars: fine enough for the acuity at two years."""
FOVY_DEG = VisionSpec().fovy_deg
MEAN, AMPLITUDE = 127.5, 120.0
"""Mean and amplitude of a grating's brightness, in a range of 0 to 255."""
SHARES_OF_ACUITY: Sequence[float] = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.05, 1.2)
"""Spatial frequencies of the gratings relative to the acuity."""


@dataclass(frozen=True, slots=True)
class Transfer:
    """The fraction of a grating's contrast that remains after the filter."""

    age_months: float
    acuity_cpd: float
    frequency_cpd: float
    measured: float

    @property
    def law(self) -> float:
        """The fraction predicted by the contrast sensitivity function (López et al. 2025, equation 2)."""
        return max(0.0, 1 - self.frequency_cpd / self.acuity_cpd)


def transfers(age_months: float, acuity_cpd: float) -> Iterator[Transfer]:
    """Yield the remaining contrast of gratings of several spatial frequencies."""
    eye = VisionEntry(
        cameras=("eye_left",),
        width_px=WIDTH_PX,
        height_px=HEIGHT_PX,
        supersample=1,
        acuity_cpd=acuity_cpd,
        foveation=0.0,
        foveation_radius="border",
        unseen=(),
    )
    seen_by = filters(eye, FOVY_DEG)
    for share in SHARES_OF_ACUITY:
        half_cycles = _half_cycles(share * acuity_cpd)
        wave = np.cos(np.pi * half_cycles * (np.arange(HEIGHT_PX) + 0.5) / HEIGHT_PX)
        grating = np.rint(MEAN + AMPLITUDE * wave).astype(np.uint8)
        seen = perceive(np.broadcast_to(grating[None, :, None, None], (1, HEIGHT_PX, WIDTH_PX, 3)), seen_by)
        left, shown = (float(picture.astype(float) @ wave) for picture in (seen[0, :, 0, 0], grating))
        yield Transfer(age_months, acuity_cpd, _frequency_cpd(half_cycles), left / shown)


def _half_cycles(frequency_cpd: float) -> int:
    """Return the number of half cycles in the image closest to a frequency, an integer to avoid border effects."""
    return max(1, round(2 * HEIGHT_PX * frequency_cpd / pixels_per_degree(HEIGHT_PX, FOVY_DEG)))


def _frequency_cpd(half_cycles: int) -> float:
    """Return the spatial frequency at the centre of the image, in cycles per degree."""
    return half_cycles / (2 * HEIGHT_PX) * pixels_per_degree(HEIGHT_PX, FOVY_DEG)

"""Luminance and chroma: what is limited of each, apart from the other.

Luminance is L = .2126 R + .7152 G + .0722 B (the primaries of BT.709), chroma what is left of red, green and blue
without it. Both are limited by acuity or by thresholds, and of chroma only what is pure enough is seen, and paler:

    purity p = 1 - min(R, G, B) / mean(R, G, B)
    chroma that is seen = gain sqrt(1 - (threshold / p)²) x chroma, or 0 if p < threshold

A purity of 0 is white, of 1 the purest colour of a hue that a picture can show, which is less pure than a light of one
wave length. So what is grey is the same in all colours, and luminance stays whatever happens to chroma.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.foveation import Pictures, contrast_gain
from mimoc.components.senses.vision.thresholds import Bands, Transform, above_threshold, stacked_bands, threshold_bands

RED, GREEN, BLUE = 0.2126, 0.7152, 0.0722
"""Share of each in luminance, by recommendation BT.709 of the ITU."""
CHROMA_ACUITY = 0.5
"""Finest chroma that is seen, relative to the finest grating in luminance: a guess."""
LEAST_PURITY = 0.01
"""Pictures of 8 bits hold no finer difference from grey: a lower threshold, such as adults', changes nothing."""
TINY = 1e-6
"""Of 255 levels; below it, there is no colour."""


@dataclass(frozen=True, slots=True)
class Limits:
    """What limits luminance and chroma of pictures; arrays have the shape (..., height, width)."""

    luminance: Bands | Any
    """Bands with thresholds, or the share that is left of each cosine; None if all of it is seen."""
    chroma: Any
    """Share that is left of each cosine; None if all are seen."""
    purity_threshold: float | None
    """Purity below which a colour is grey; None if none is."""
    chroma_gain: float
    """Share that is left of the chroma of other colours."""

    def mapped(self, change: Callable[[Any], Any]) -> "Limits":
        """Return these with all arrays changed."""
        luminance = self.luminance
        if luminance is not None:
            luminance = luminance.mapped(change) if isinstance(luminance, Bands) else change(luminance)
        chroma = None if self.chroma is None else change(self.chroma)
        return Limits(luminance, chroma, self.purity_threshold, self.chroma_gain)


def limits_of(entry: VisionEntry, size_px: tuple[int, int], fovy_deg: float) -> Limits | None:
    """Return what limits pictures of a size, width and height; None if nothing limits luminance apart from chroma."""
    is_threshold, purity = entry.contrast == "threshold", entry.purity_threshold
    if not is_threshold and purity is None:
        return None
    shares, acuity_cpd = entry.acuity_shares or (1.0,), entry.acuity_cpd
    if is_threshold and entry.sensitivity is not None and entry.sensitivity_peak_cpd is not None:
        luminance: Any = stacked_bands(
            tuple(
                threshold_bands(
                    size_px,
                    fovy_deg,
                    entry.sensitivity,
                    share * entry.sensitivity_peak_cpd,
                    None if acuity_cpd is None else share * acuity_cpd,
                )
                for share in shares
            )
        )
    else:
        luminance = _gains(entry, size_px, fovy_deg, shares)
    finest = tuple(share * (1.0 if purity is None else CHROMA_ACUITY) for share in shares)
    seen = purity if purity is not None and (purity >= LEAST_PURITY or entry.chroma_gain < 1) else None
    return Limits(luminance, _gains(entry, size_px, fovy_deg, finest), seen, entry.chroma_gain)


def _gains(entry: VisionEntry, size_px: tuple[int, int], fovy_deg: float, shares: tuple[float, ...]) -> Pictures | None:
    """Return the share that is left of each cosine, with some shares of the acuity; None if that is not limited."""
    if entry.acuity_cpd is None:
        return None
    law = "linear" if entry.contrast == "threshold" else entry.contrast
    gains = [contrast_gain(*size_px, fovy_deg, share * entry.acuity_cpd, law) for share in shares]
    return np.stack(gains) if len(gains) > 1 else gains[0]


def limit_colours(pictures: Any, limits: Limits, transform: Transform) -> Any:
    """Return pictures, shape (..., height, width, 3), whose luminance and chroma are limited."""
    drawn = RED * pictures[..., 0] + GREEN * pictures[..., 1] + BLUE * pictures[..., 2]
    seen = _limited(drawn, limits.luminance, transform)
    if limits.chroma is None and limits.purity_threshold is None:
        change, result = seen - drawn, pictures * 1
        for colour in range(3):  # Faster than one sum whose innermost axis has three numbers.
            result[..., colour] += change
        return result
    red, blue = (_limited(pictures[..., colour] - drawn, limits.chroma, transform) for colour in (0, 2))
    green = (RED * red + BLUE * blue) / -GREEN
    chroma = transform.xp.stack([red, green, blue], -1)
    if limits.purity_threshold is not None:
        chroma = chroma * _share_seen(seen, chroma, limits, transform.xp)[..., None]
    return seen[..., None] + chroma


def _limited(planes: Any, limit: Bands | Any, transform: Transform) -> Any:
    """Return planes of which each cosine, or what is above the threshold, is left."""
    if limit is None:
        return planes
    if isinstance(limit, Bands):
        return above_threshold(planes, limit, transform)
    return transform.inverse(transform.forward(planes) * limit)


def _share_seen(luminance: Any, chroma: Any, limits: Limits, xp: Any) -> Any:
    """Return the share of the chroma of each pixel that is seen, shape (..., height, width)."""
    red, green, blue = chroma[..., 0], chroma[..., 1], chroma[..., 2]
    least = xp.minimum(xp.minimum(red, green), blue)
    mean = (red + green + blue) / 3
    pure, threshold = mean - least, limits.purity_threshold * (luminance + mean)
    return limits.chroma_gain * xp.sqrt((pure * pure - threshold * threshold).clip(0)) / pure.clip(TINY)

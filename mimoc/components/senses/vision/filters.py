"""What eyes lose of a picture besides acuity: colour, focus, and what flickers.

Luminance and chroma: what is limited of each, apart from the other.

Luminance is L = .2126 R + .7152 G + .0722 B (the primaries of BT.709), chroma what is left of red, green and blue
without it. Both are limited by acuity or by thresholds, and of chroma only what is pure enough is seen, and paler:

    purity p = 1 - min(R, G, B) / mean(R, G, B)
    chroma that is seen = gain sqrt(1 - (threshold / p)²) x chroma, or 0 if p < threshold

A purity of 0 is white, of 1 the purest colour of a hue that a picture can show, which is less pure than a light of one
wave length. So what is grey is the same in all colours, and luminance stays whatever happens to chroma.

Defocus: what is nearer or farther than an eye is focused on is blurred, by the disc that its light spreads to.

    defocus = unfocused |1 / d - 1 / .25 m| - depth of focus     in dioptres, at a distance d
    diameter of the disc = .057 x defocus x pupil in mm          in degrees (by geometry: 1 / 1000 rad)

A picture is blurred by discs of a few sizes, and each pixel is interpolated between the two nearest sizes by its own
distance. So the blur of what is near does not spread over what is behind it.

Flicker: how fast changes can be seen, as a low-pass filter of first order over time.

    seen = seen before + (1 - exp(-2 pi f t)) (now - seen before)

for pictures t apart, which is exact for what stays as it is from one picture to the next. It filters what the infant
sees otherwise, after acuity, contrast and colour, and begins with the first picture of an episode.
"""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy import fft, special

from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.foveation import (
    ROWS_AND_COLUMNS,
    FloatArray,
    Pictures,
    contrast_gain,
    cosine_frequencies_cpd,
    pixel_tangents,
    read_only,
)
from mimoc.components.senses.vision.thresholds import Bands, Transform, above_threshold, stacked_bands, threshold_bands
from mimoc.runtime.filter import Filter

RED, GREEN, BLUE = 0.2126, 0.7152, 0.0722  # Share of each in luminance, by recommendation BT.709 of the ITU.
CHROMA_ACUITY = 0.5  # Finest chroma that is seen, relative to the finest grating in luminance: a guess.
MIN_PURITY = 0.01
"""Pictures of 8 bits hold no finer difference from grey: a lower threshold, such as adults', changes nothing."""
TINY = 1e-6  # Difference from grey, on a scale of 255 levels, below which there is no colour.


@dataclass(frozen=True, slots=True)
class Limits:
    """What limits luminance and chroma of pictures; arrays have the shape (..., height, width)."""

    luminance: Bands | Any
    """Bands with thresholds, or the share that is left of each cosine; None if all of it is seen."""
    chroma: Any  # Share that is left of each cosine; None if all are seen.
    purity_threshold: float | None  # Purity below which a colour is grey; None if none is.
    chroma_gain: float  # Share that is left of the chroma of other colours.

    def mapped(self, change: Callable[[Any], Any]) -> "Limits":
        """Return these with all arrays changed."""
        luminance = self.luminance
        if luminance is not None:
            luminance = luminance.mapped(change) if isinstance(luminance, Bands) else change(luminance)
        chroma = None if self.chroma is None else change(self.chroma)
        return Limits(luminance, chroma, self.purity_threshold, self.chroma_gain)


def limits_of(entry: VisionEntry, size_px: tuple[int, int], fovy_deg: float) -> Limits | None:
    """Return what limits pictures of a size, width and height; None if nothing limits luminance apart from chroma."""
    is_threshold = entry.contrast == "threshold"
    purity = entry.purity_threshold
    if not is_threshold and purity is None:
        return None
    shares = entry.acuity_shares or (1.0,)
    acuity_cpd = entry.acuity_cpd
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
        luminance = contrast_gains(entry, size_px, fovy_deg, shares)
    finest = tuple(share * (1.0 if purity is None else CHROMA_ACUITY) for share in shares)
    seen = purity if purity is not None and (purity >= MIN_PURITY or entry.chroma_gain < 1) else None
    return Limits(luminance, contrast_gains(entry, size_px, fovy_deg, finest), seen, entry.chroma_gain)


def contrast_gains(
    entry: VisionEntry, size_px: tuple[int, int], fovy_deg: float, shares: tuple[float, ...]
) -> Pictures | None:
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
    pure = mean - least
    threshold = limits.purity_threshold * (luminance + mean)
    return limits.chroma_gain * xp.sqrt((pure * pure - threshold * threshold).clip(0)) / pure.clip(TINY)


@dataclass(frozen=True)
class Persistence(Filter):
    """The filter of pictures in 8 bits."""

    flicker_hz: npt.NDArray[np.float64]  # f, shape (1,).

    def __call__(self, xp: Any, elapsed_s: float, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return the pictures that are seen, in 8 bits, and without rounding; see `Filter`."""
        now = xp.astype(sample, xp.float32)
        if state is None:
            return sample, now
        rows = xp.reshape(xp.astype(self.flicker_hz, xp.float32), (-1, *[1] * (len(sample.shape) - 1)))
        seen = state + (1.0 - xp.exp(rows * (-2 * math.pi * elapsed_s))) * (now - state)
        return xp.astype(xp.round(seen), xp.uint8), seen


def filter_of(entry: VisionEntry) -> Persistence | None:
    """Return the filter of an infant's pictures; None if it has none."""
    return None if entry.flicker_hz is None else Persistence(np.array([entry.flicker_hz]))


EDGE_DEG = 10.0  # Within which visibility falls from 1 to 0, as half a cosine: a choice.


@functools.lru_cache(maxsize=32)
def noticed_share(width_px: int, height_px: int, fovy_deg: float, noticed_deg: float) -> Pictures:
    """Return how much of each pixel is noticed, shape (height, width), from 0 to 1; read-only.

    It is 1 up to *noticed_deg* from the line of sight, and 0 from 10° more on. In a picture so coarse that the middle
    of each pixel is beyond that, the pixels next to the line of sight are noticed.
    """
    across, down = pixel_tangents(width_px, height_px, fovy_deg)
    angles_deg = np.degrees(np.arctan(np.hypot(down[:, None], across)))
    beyond = ((angles_deg - noticed_deg) / EDGE_DEG).clip(0, 1)
    share = read_only(0.5 + 0.5 * np.cos(np.pi * beyond))
    return share if share.any() else read_only(np.isclose(angles_deg, angles_deg.min()))


def fade(pictures: Any, share: Any) -> Any:
    """Return pictures of any array library that fade to the mean of what is noticed, each colour to its own.

    *share* is how much of each pixel is noticed, shape (..., height, width, 1 or colours).
    """
    noticed = pictures * share
    mean = noticed.sum((-3, -2))[..., None, None, :] / share.sum((-3, -2))[..., None, None, :]
    return noticed + mean * (1 - share)


FOCUSED_M = 0.25
"""Distance that newborns' eyes are focused on: between Haynes, White & Held's 19 cm (1965) and Hainline et al.'s 30
(1992)."""
PUPIL_MM = 4.5  # Diameter of the pupil: assumed, 4 to 5.
DEG_PER_DIOPTRE_MM = float(np.degrees(1e-3))  # Angle of the disc by defocus and pupil.
NEAREST_M = 0.1  # Nearer things are blurred as there.
SIZES = (0.5, 1.0)  # Discs by which pictures are blurred, relative to the largest, besides none.


@dataclass(frozen=True, slots=True)
class Lens:
    """An eye's focus."""

    unfocused: float  # Share of the distance in dioptres from `FOCUSED_M` by which it is out of focus.
    depth_dioptres: float  # Defocus that blurs nothing.

    def disc_deg(self, distance_m: npt.NDArray[np.floating] | float) -> FloatArray:
        """Return the diameter of the disc that a point at a distance is seen as."""
        away = np.abs(1 / np.maximum(distance_m, NEAREST_M) - 1 / FOCUSED_M)
        return DEG_PER_DIOPTRE_MM * PUPIL_MM * np.maximum(self.unfocused * away - self.depth_dioptres, 0)


def defocus(pictures: Pictures, distances_m: npt.NDArray[np.float32], lens: Lens, fovy_deg: float) -> Pictures:
    """Return pictures, shape (..., height, width, colours), out of focus.

    *distances_m* is how far what each pixel shows is from the eye along the line of sight, shape (..., height, width).
    """
    largest_deg = float(lens.disc_deg(NEAREST_M))
    if not largest_deg:
        return pictures
    spectrum = np.asarray(fft.dctn(pictures, axes=ROWS_AND_COLUMNS))
    height, width = pictures.shape[-3:-1]
    step = len(SIZES) * lens.disc_deg(distances_m).astype(np.float32) / np.float32(largest_deg)
    seen = pictures * (1 - step).clip(0)[..., None]
    for number, size in enumerate(SIZES, start=1):
        gain = disc_gain(width, height, fovy_deg, size * largest_deg)[..., None]
        blurred = np.asarray(fft.idctn(spectrum * gain, axes=ROWS_AND_COLUMNS))
        seen += blurred * (1 - np.abs(step - number)).clip(0)[..., None]
    return seen


@functools.lru_cache(maxsize=32)
def disc_gain(width_px: int, height_px: int, fovy_deg: float, disc_deg: float) -> npt.NDArray[np.float32]:
    """Return how much is left of each cosine of a picture that is blurred by a disc, shape (height, width); read-only.

    It is 2 J1(x) / x with x = pi disc f; where that is negative, gratings are seen with dark and light exchanged.
    """
    x = np.maximum(np.pi * disc_deg * cosine_frequencies_cpd(width_px, height_px, fovy_deg), 1e-9)
    return read_only(2 * special.j1(x) / x)


def distances(depths: npt.NDArray[np.float32], near_m: float, far_m: float) -> npt.NDArray[np.float32]:
    """Return distances along the line of sight from OpenGL's depths, 0 at the near and 1 at the far plane."""
    return np.float32(near_m) / (1 - depths * np.float32(1 - near_m / far_m))

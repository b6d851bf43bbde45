"""A recorded sound that a script lets sound at a place, as from a loudspeaker."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.senses.sense import FloatArray

LONGEST = 10_000_000
"""Samples of a sound; some minutes."""
RATES_HZ = 1000.0, 400_000.0


@dataclass(frozen=True, slots=True)
class Playback:
    """A sound and its place."""

    pressure_pa: FloatArray
    """Sound pressure at 1 m, shape (n,), [Pa]."""
    rate_hz: float
    """Samples per second."""
    point_m: tuple[float, ...]
    """Place in the frame of its body, shape (3,)."""
    body: int
    """The body that it moves with; 0 is the world."""


def checked_playback(pressure_pa: Any, rate_hz: Any, point_m: Sequence[float], body: int) -> Playback:
    """Return a sound, or raise a ValueError that says what is wrong with it."""
    pressure, place = np.asarray(pressure_pa, np.float64), np.asarray(point_m, np.float64)
    if pressure.ndim != 1 or not 2 <= len(pressure) <= LONGEST or not np.isfinite(pressure).all():
        raise ValueError(f"expected 2 to {LONGEST} finite samples of a sound pressure, got shape {pressure.shape}")
    if place.shape != (3,) or not np.isfinite(place).all():
        raise ValueError(f"expected a place of three finite numbers, got {point_m!r:.60}")
    if not RATES_HZ[0] <= float(rate_hz) <= RATES_HZ[1]:
        raise ValueError(f"expected a sample rate from {RATES_HZ[0]:g} to {RATES_HZ[1]:g} Hz, got {rate_hz!r:.60}")
    return Playback(pressure, float(rate_hz), tuple(place.tolist()), body)

"""A recorded sound that a script lets sound at a place, as from a loudspeaker."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.runtime.sense import FloatArray

MAX_SAMPLES = 3_000_000
"""A minute at 48 kHz."""
MAX_S = 60.0
"""Longest sound: whatever its own rate, it is kept at that of the ears."""
MAX_PA = 1e5
"""Largest sound pressure: that of the air, below which no sound in air can fall."""
MAX_M = 1000.0
"""Largest coordinate of a place."""
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


def checked_playback(pressure_pa: Any, rate_hz: Any, point_m: Any, body: int) -> Playback:
    """Return a sound, or raise a ValueError that says what is wrong with it."""
    pressure, place, rate = _numbers(pressure_pa), _numbers(point_m), _numbers(rate_hz)
    if rate is None or rate.shape != () or not RATES_HZ[0] <= rate <= RATES_HZ[1]:
        raise ValueError(f"expected a sample rate from {RATES_HZ[0]:g} to {RATES_HZ[1]:g} Hz, got {rate_hz!r:.60}")
    most = min(MAX_SAMPLES, int(MAX_S * rate))
    if pressure is None or pressure.ndim != 1 or not 2 <= len(pressure) <= most:
        shape = "other data" if pressure is None else f"shape {pressure.shape}"
        raise ValueError(f"expected 2 to {most:,} samples ({MAX_S:g} s at most) of a sound pressure, got {shape}")
    if not np.abs(pressure).max() <= MAX_PA:
        raise ValueError(f"expected finite sound pressures of at most {MAX_PA:g} Pa, got {np.abs(pressure).max():g}")
    if place is None or place.shape != (3,) or not np.abs(place).max() <= MAX_M:
        raise ValueError(f"expected a place of three numbers of at most {MAX_M:g} m, got {point_m!r:.60}")
    return Playback(pressure, float(rate), tuple(place.tolist()), body)


def _numbers(values: Any) -> FloatArray | None:
    """Return an array of real numbers, or None if it is none."""
    try:
        array = np.asarray(values)
    except ValueError:  # Rows of several lengths.
        return None
    return array.astype(np.float64) if array.dtype.kind in "iuf" else None

"""What sounds are like: the sound pressure of an impact, a voice or a tone by time, for a level of 0 dB at 1 m.

They are made at `FINER` times the sample rate, so that they can be heard with any delay, by linear interpolation. Each is
a complex array: the real part is the sound as it is, the imaginary part what all heads let pass alike
(`mimoc.geometry.spherical_head`).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mimoc.geometry.spherical_head import low_part
from mimoc.senses.hearing.cochlea import REFERENCE_PA
from mimoc.senses.sense import FloatArray

ComplexArray = npt.NDArray[np.complex64]

FINER = 4
"""A frequency of a third of the sample rate loses .3 dB at most."""
MARGIN_S = 2e-3
"""Silence before and after a sound, into which the low part of it rings."""
PARTIALS = (1.0, 2.757, 5.404, 8.933)
"""Frequencies of a free beam, relative to the lowest (Fletcher & Rossing 1998), for want of an object's own."""
LONGEST_S = 1.5
"""After which what rings on is cut."""
GLIDE_S = 0.02
"""Of the onset and the end of voices and tones."""
SLOPE_DB = 12.0
"""By which the harmonics of a voice fall per octave, as the glottal source's (Fant 1960)."""


class Timbre(NamedTuple):
    """What a sound is like; equal ones are made once."""

    kind: str
    """`impact`, `voice` or `tone`."""
    fundamental_hz: float
    """Of the lowest partial."""
    duration_ms: float
    """Of a voice or a tone; of an impact, the time after which its lowest partial is down by 60 dB."""
    contact_ms: float = 0.0
    """How long the objects touch that hit each other: partials of shorter periods are weak."""


@dataclass(frozen=True)
class Maker:
    """Makes sounds for a head and a sample rate."""

    sample_rate_hz: float
    radius_m: float

    def make(self, timbre: Timbre) -> ComplexArray:
        """Return the pressure of a timbre, [Pa] at 1 m; its root mean square is 20 µPa, while it lasts."""
        pressure = IMPACT(self, timbre) if timbre.kind == "impact" else HARMONIC(self, timbre)
        return self.of_pressure(REFERENCE_PA * pressure)

    def of_pressure(self, pressure_pa: FloatArray) -> ComplexArray:
        """Return a sound at the finer rate with its low part, with silence before and after."""
        margin = round(MARGIN_S * FINER * self.sample_rate_hz)
        padded = np.pad(pressure_pa, (margin, margin))
        frequencies_hz = np.fft.rfftfreq(len(padded), 1 / (FINER * self.sample_rate_hz))
        low = np.fft.irfft(np.fft.rfft(padded) * low_part(frequencies_hz, self.radius_m), len(padded))
        return (padded + 1j * low).astype(np.complex64)

    def resampled(self, pressure_pa: FloatArray, rate_hz: float) -> FloatArray:
        """Return a recorded pressure, shape (n,), at the finer rate."""
        size = round(len(pressure_pa) * FINER * self.sample_rate_hz / rate_hz)
        spectrum = np.fft.rfft(pressure_pa)[: size // 2 + 1]
        return np.fft.irfft(spectrum, size) * (size / len(pressure_pa))

    def times_s(self, duration_s: float) -> FloatArray:
        """Return the times of the finer samples of a duration."""
        return np.arange(math.ceil(duration_s * FINER * self.sample_rate_hz)) / (FINER * self.sample_rate_hz)


def _impact(maker: Maker, timbre: Timbre) -> FloatArray:
    """Return partials that decay together with their periods: each by 60 dB within the same number of them."""
    frequencies_hz = _below(maker, [timbre.fundamental_hz * ratio for ratio in PARTIALS])
    decays_s = timbre.duration_ms / 1000 / math.log(1000) * timbre.fundamental_hz / frequencies_hz
    sizes = 1 / (np.arange(len(frequencies_hz)) + 1) / (1 + (2 * frequencies_hz * timbre.contact_ms / 1000) ** 2)
    times_s = maker.times_s(min(LONGEST_S, math.log(1000) * float(decays_s.max())))
    pressure = np.zeros(len(times_s))
    for frequency_hz, decay_s, size in zip(frequencies_hz, decays_s, sizes, strict=True):
        pressure += size * np.exp(-times_s / decay_s) * np.sin(2 * np.pi * frequency_hz * times_s)
    pressure *= np.minimum(1.0, (times_s[-1] - times_s) / GLIDE_S)
    power = float(np.sum(sizes**2 * decays_s) / 4)  # Of a decaying sine: size² decay / 4.
    return pressure / math.sqrt(power / IMPACT_S)


def _harmonic(maker: Maker, timbre: Timbre) -> FloatArray:
    """Return a voice, whose harmonics fall by 12 dB per octave, or a pure tone, with smooth ends."""
    multiples = np.arange(1, 31) if timbre.kind == "voice" else np.array([1])
    frequencies_hz = _below(maker, timbre.fundamental_hz * multiples)
    sizes = multiples[: len(frequencies_hz)] ** -(SLOPE_DB / (20 * math.log10(2)))
    times_s = maker.times_s(timbre.duration_ms / 1000)
    pressure = sizes @ np.sin(2 * np.pi * frequencies_hz[:, None] * times_s)
    ends = np.minimum(times_s, times_s[-1] - times_s) / min(GLIDE_S, timbre.duration_ms / 4000)
    pressure *= np.sin(np.pi / 2 * np.minimum(1.0, ends)) ** 2
    return pressure / math.sqrt(float(np.sum(sizes**2)) / 2)


def _below(maker: Maker, frequencies_hz: Sequence[float] | FloatArray) -> FloatArray:
    """Return those frequencies that the sample rate can hold, or the highest that it can."""
    highest_hz = 0.45 * maker.sample_rate_hz
    return np.array([hz for hz in frequencies_hz if hz < highest_hz] or [highest_hz])


IMPACT_S = 0.125
"""Time over which the level of an impact is the mean: `fast` of a sound level meter (IEC 61672)."""
IMPACT, HARMONIC = _impact, _harmonic

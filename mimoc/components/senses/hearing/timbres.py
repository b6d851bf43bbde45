"""What sounds are like: the sound pressure of an impact, a voice or a tone by time.

They are made at `FINER` times the sample rate, so that they can be heard with any delay, by linear interpolation. Each
is a complex array: its real part is the sound as it is, its imaginary part what all heads let pass alike
(`mimoc.base.geometry.spherical_head.low_part`).
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.spherical_head import low_part
from mimoc.components.senses.hearing.cochlea import REFERENCE_PA
from mimoc.runtime.sense import FloatArray

Wave = npt.NDArray[np.complex64]

FINER = 4
"""A frequency of a third of the sample rate loses .3 dB at most."""
PARTIALS = np.array([1.0, 2.757, 5.404, 8.933])
"""Frequencies of a free beam, relative to the lowest (Fletcher & Rossing 1998), for want of an object's own."""
LONGEST_S, SHORTEST_S = 10.0, 2e-3
"""Durations of sounds."""
GLIDE_S = 0.02
"""Of the onset and the end of voices and tones, and of the end of what rings on."""
HARMONICS, SLOPE_DB = 30, 12.0
"""Of a voice: their number, and by how much they fall per octave, as the glottal source's do (Fant 1960, from memory);
there are no formants."""
PERIOD = 2048
"""Samples of a period of a voice."""
IMPACT_S = 0.125
"""Time over which the level of an impact is the mean, as that of `fast` sound level meters (IEC 61672)."""


class Timbre(NamedTuple):
    """What a sound is like; equal ones are made once."""

    kind: str
    """`impact`, `voice`, or a pure tone for all else."""
    fundamental_hz: float
    """Of the lowest partial."""
    duration_ms: float
    """Of a voice or a tone; of an impact, the time after which its lowest partial is down by 60 dB."""
    contact_ms: float = 0.0
    """How long the objects touch that hit each other: partials of shorter periods are weak."""


@dataclass(frozen=True)
class Head:
    """For whose head, and with how many samples per second, sounds are made."""

    radius_m: float
    sample_rate_hz: float

    @property
    def finer_hz(self) -> float:
        """Sample rate of waves."""
        return FINER * self.sample_rate_hz


@lru_cache(maxsize=64)
def wave_of(timbre: Timbre, head: Head) -> Wave:
    """Return the wave of a timbre, in [Pa] at 1 m; its level is 0 dB re 20 µPa, of hard contacts."""
    duration_s = min(max(timbre.duration_ms / 1000, SHORTEST_S), LONGEST_S)
    times_s = np.arange(math.ceil(duration_s * head.finer_hz)) / head.finer_hz
    wave = (_impact if timbre.kind == "impact" else _harmonic)(timbre, times_s, head)
    wave = (REFERENCE_PA * wave).astype(np.complex64)
    wave.flags.writeable = False
    return wave


def wave_of_pressure(pressure_pa: FloatArray, rate_hz: float, head: Head) -> Wave:
    """Return the wave of a recorded pressure at 1 m, shape (n,)."""
    size = max(2, round(len(pressure_pa) * head.finer_hz / rate_hz))
    spectrum = np.fft.rfft(pressure_pa)[: size // 2 + 1]
    low = low_part(np.arange(len(spectrum)) * rate_hz / len(pressure_pa), head.radius_m)
    sounds = np.fft.irfft(np.stack([spectrum, spectrum * low]), size) * (size / len(pressure_pa))
    return (sounds[0] + 1j * sounds[1]).astype(np.complex64)


def resampled(pressure_pa: FloatArray, rate_hz: float, wanted_hz: float) -> FloatArray:
    """Return a recorded pressure, shape (n,), at another sample rate."""
    size = max(2, round(len(pressure_pa) * wanted_hz / rate_hz))
    spectrum = np.fft.rfft(pressure_pa)[: size // 2 + 1]
    return np.fft.irfft(spectrum, size) * (size / len(pressure_pa))


def _impact(timbre: Timbre, times_s: FloatArray, head: Head) -> Any:
    """Return partials that decay together with their periods: each by 60 dB within the same number of them."""
    frequencies_hz, sizes = partials_of(timbre, head)
    decays_s = timbre.duration_ms / 1000 / math.log(1000) * frequencies_hz[0] / frequencies_hz
    hard = 1 / (np.arange(len(frequencies_hz)) + 1)
    energy = float(np.sum(hard**2 * decays_s)) / 4  # Of a decaying sine: size² decay / 4.
    ends = np.minimum(1.0, (times_s[-1] - times_s) / min(GLIDE_S, times_s[-1] / 2))
    wave = np.zeros(len(times_s), complex)
    for frequency_hz, decay_s, size in zip(frequencies_hz, decays_s, sizes, strict=True):
        partial = np.exp(-times_s / decay_s) * np.sin(2 * np.pi * frequency_hz * times_s)
        wave += size * (1 + 1j * low_part(frequency_hz, head.radius_m)) * partial
    return ends * wave / math.sqrt(energy / IMPACT_S)


@lru_cache(maxsize=256)
def partials_of(timbre: Timbre, head: Head) -> tuple[FloatArray, FloatArray]:
    """Return the frequencies of an impact's partials, and their amplitudes relative to the first of a hard contact."""
    frequencies_hz = _below(timbre.fundamental_hz * PARTIALS, head)
    softness = 2e-3 * frequencies_hz * timbre.contact_ms
    return frequencies_hz, 1 / (np.arange(len(frequencies_hz)) + 1) / (1 + softness**2)


def _harmonic(timbre: Timbre, times_s: FloatArray, head: Head) -> Any:
    """Return a voice or a pure tone, with smooth ends."""
    period = harmonic_period(timbre.fundamental_hz, HARMONICS if timbre.kind == "voice" else 1, head)
    places = (times_s * min(timbre.fundamental_hz, 0.45 * head.sample_rate_hz) * PERIOD).astype(np.int64) % PERIOD
    ends = np.minimum(times_s, times_s[-1] - times_s) / min(GLIDE_S, times_s[-1] / 4)
    return period[places] * np.sin(np.pi / 2 * np.minimum(1.0, ends)) ** 2


def harmonic_period(fundamental_hz: float, harmonics: int, head: Head) -> npt.NDArray[np.complex128]:
    """Return a period of a sound with some harmonics, shape (`PERIOD`,), with a root mean square of 1."""
    frequencies_hz = _below(fundamental_hz * np.arange(1, harmonics + 1), head)
    numbers = np.arange(1, len(frequencies_hz) + 1)
    sizes = numbers ** -(SLOPE_DB / (20 * math.log10(2)))
    weights = sizes * (1 + 1j * low_part(frequencies_hz, head.radius_m))
    return weights @ _SINES[: len(numbers)] / math.sqrt(float(np.sum(sizes**2)) / 2)


_SINES = np.sin(2 * np.pi / PERIOD * np.outer(np.arange(1, HARMONICS + 1), np.arange(PERIOD)))


def _below(frequencies_hz: Any, head: Head) -> FloatArray:
    """Return those frequencies that the sample rate can hold, or the highest that it can."""
    highest_hz = 0.45 * head.sample_rate_hz
    kept = frequencies_hz[frequencies_hz < highest_hz]
    return kept if len(kept) else np.array([highest_hz])

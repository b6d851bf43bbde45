"""Hearing: what reaches the ears, as an infant of its age hears it, in frequency bands.

The n-th band is a gammatone filter of fourth order about a frequency f_n (Patterson et al. 1992), whose width is that
of adults' auditory filters, ERB(f) = 24.7 (4.37 f / 1000 + 1) in [Hz] (Glasberg & Moore 1990):

    |G_n(f)|² = (1 + ((f - f_n) / (1.019 ERB(f_n)))²)⁻⁴.

Its level is 10 log10(Σ |X(f)|² |G_n(f)|² / p₀²) over the spectrum X of a window of time, so that a lasting tone of that
frequency has its sound pressure level there, re p₀ = 20 µPa. Infants' filters are as wide as adults' here; theirs are
so from 6 months on (Spetner & Olsho 1990, from memory).
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
from gymnasium.spaces import Box

from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.components.senses.hearing import HearingEntry
from mimoc.components.senses.hearing.listener import Listener, checked_playback
from mimoc.components.senses.hearing.sounds import REFERENCE_PA
from mimoc.runtime.noise import Draw, Noise
from mimoc.runtime.sense import FloatArray, Observation, Sample, Sense
from mimoc.runtime.sound import SoundSources, Voice

WINDOW_S = 0.025  # Time over which levels of bands are means, weighted by a Hann window, as is usual for speech.
LOUDEST_PA = 20.0  # Bound of the observed sound pressure: 120 dB re 20 µPa.
LOUDEST_DB = 140.0  # Bound of observed levels: no tone of 120 dB is as far above adults' thresholds.
EARS = "left", "right"
LOWEST_HZ, HIGHEST_HZ = 100.0, 8000.0  # Centre frequencies of the lowest and the highest band.
HIGHEST_SHARE = 0.9  # The highest band is below this share of half the sample rate.
WIDTH = 1.019  # Width of a gammatone filter, in equivalent rectangular bandwidths.
ORDER = 4  # Order of the gammatone filters.
SILENCE = 1e-30  # Added to mean squares relative to that of the reference, so that silence has a logarithm.


def erb_hz(frequency_hz: Any) -> Any:
    """Return the equivalent rectangular bandwidth of the auditory filter about a frequency (Glasberg & Moore 1990).

    Example:
        >>> from mimoc.components.senses.hearing.run import erb_hz
        >>> round(erb_hz(1000.0), 1)
        132.6
    """
    return 24.7 * (4.37e-3 * frequency_hz + 1)


def band_centres_hz(channels: int, sample_rate_hz: float) -> FloatArray:
    """Return frequencies that are equally far from each other in bandwidths, shape (channels,), rising."""
    ends_hz = np.array([LOWEST_HZ, min(HIGHEST_HZ, HIGHEST_SHARE * sample_rate_hz / 2)])
    first, last = 21.4 * np.log10(4.37e-3 * ends_hz + 1)
    return (10 ** (np.linspace(first, last, channels) / 21.4) - 1) / 4.37e-3


@dataclass(frozen=True)
class Bands:
    """The frequency bands of an ear, for windows of a number of samples."""

    centres_hz: FloatArray  # Shape (channels,).
    sample_rate_hz: float
    window: FloatArray  # What samples are multiplied with, shape (samples,).

    @cached_property
    def _weights(self) -> FloatArray:
        """Matrix from the power at each frequency to the mean square pressure of each band, (frequencies, channels)."""
        size = len(self.window)
        frequencies_hz = np.fft.rfftfreq(size, 1 / self.sample_rate_hz)[:, None]
        offsets = (frequencies_hz - self.centres_hz) / (WIDTH * erb_hz(self.centres_hz))
        weights = (1 + offsets * offsets) ** -float(ORDER)
        times_s = np.arange(size) / self.sample_rate_hz
        phases = 2 * np.pi * (self.centres_hz[:, None, None] * times_s + np.array([[0.0], [0.25]]))
        # Two tones in quadrature, whose mean is taken: in a short window, the power of one tone depends on its phase.
        tones = np.abs(np.fft.rfft(np.cos(phases) * self.window)) ** 2
        heard = np.einsum("bpf,fb->b", tones, weights) / 2
        return 0.5 * weights / heard  # The mean square of a tone of amplitude 1 is a half.

    def mean_squares(self, pressure_pa: FloatArray) -> FloatArray:
        """Return the mean square of the pressure in each band, shape (..., channels), of sounds (..., samples)."""
        spectrum = np.fft.rfft(pressure_pa * self.window)
        return (spectrum.real**2 + spectrum.imag**2) @ self._weights

    def levels_db(self, pressure_pa: FloatArray) -> FloatArray:
        """Return the level of each band, shape (..., channels), in dB re 20 µPa."""
        return 10 * np.log10(self.mean_squares(pressure_pa) / REFERENCE_PA**2 + SILENCE)


def thresholds_at(frequencies_hz: FloatArray, table_hz: Any, table_db: Any) -> FloatArray:
    """Return what is just heard at frequencies, by a table that is interpolated over log frequency.

    Without a table it is 0 dB.
    """
    if not len(table_hz):
        return np.zeros(len(frequencies_hz))
    return np.interp(np.log(frequencies_hz), np.log(table_hz), table_db)


class Output(ABC):
    """What is observed of the sound pressure at two ears."""

    low: float
    high: float

    def __init__(self, bands: Bands, thresholds_db: FloatArray, has_thresholds: bool):
        self.bands = bands
        self.thresholds_db = thresholds_db
        self.has_thresholds = has_thresholds
        self._least_pa = REFERENCE_PA * 10 ** (float(thresholds_db.min()) / 20)

    @property
    @abstractmethod
    def names(self) -> list[str]:
        """What each number of an ear is, with its unit."""

    @abstractmethod
    def __call__(self, pressure_pa: FloatArray) -> FloatArray:
        """Return the numbers of each ear, shape (2, n), from the sound pressure of the window, (2, samples)."""

    def is_silent(self, pressure_pa: FloatArray) -> bool:
        """Return whether no sample is as large as the root mean square of what is just heard in any band."""
        return bool(max(pressure_pa.max(), -pressure_pa.min()) < self._least_pa)

    def above_threshold_db(self, pressure_pa: FloatArray) -> FloatArray:
        """Return how far the level of each band is above its threshold, shape (2, channels)."""
        return self.bands.levels_db(pressure_pa) - self.thresholds_db


class Cochleagram(Output):
    """How far the level of each band is above its threshold in [dB], or 0 below it."""

    low, high = 0.0, LOUDEST_DB

    @property
    def names(self) -> list[str]:
        """The centre of each band."""
        return [f"{centre_hz:.0f} Hz [dB]" for centre_hz in self.bands.centres_hz]

    def __call__(self, pressure_pa: FloatArray) -> FloatArray:
        """Return the levels of all bands."""
        if self.is_silent(pressure_pa):
            return np.zeros((len(EARS), len(self.thresholds_db)))
        return np.maximum(self.above_threshold_db(pressure_pa), 0.0)


class Levels(Cochleagram):
    """How far the level of the loudest band is above its threshold."""

    @property
    def names(self) -> list[str]:
        """One number."""
        return ["loudest band [dB]"]

    def __call__(self, pressure_pa: FloatArray) -> FloatArray:
        """Return the largest level of each ear."""
        return super().__call__(pressure_pa).max(axis=1, keepdims=True)


class Waveform(Output):
    """The sound pressure of each sample in [Pa]; 0 of an ear at which no band is above its threshold."""

    low, high = -LOUDEST_PA, LOUDEST_PA

    @property
    def names(self) -> list[str]:
        """The number of each sample."""
        return [f"{index} [Pa]" for index in range(len(self.bands.window))]

    def __call__(self, pressure_pa: FloatArray) -> FloatArray:
        """Return the samples of the window, which is as long as a control step."""
        if not self.has_thresholds:
            return pressure_pa.copy()
        if self.is_silent(pressure_pa):
            return np.zeros_like(pressure_pa)
        return pressure_pa * (self.above_threshold_db(pressure_pa).max(axis=1, keepdims=True) > 0)


OUTPUTS: dict[str, type[Output]] = {"cochleagram": Cochleagram, "levels": Levels, "waveform": Waveform}


class Hearing(Sense):
    """What both ears hear, the left one first, shape (2, n)."""

    def __init__(self, output: Output, listener: Listener, head: int):
        self.bodies = np.full(len(EARS), head, np.intp)
        self.output = output
        self.listener = listener
        self.companion = listener
        self.names = output.names
        low, high = output.low, output.high
        self.spaces = {"hearing": Box(low, high, (len(EARS), len(self.names)), np.float32)}

    @property
    def layout(self) -> tuple[str, ...]:
        """What each number is."""
        return tuple(f"{ear} {name}" for ear in EARS for name in self.names)

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return what is heard now, or since the last sample."""
        return self.output(self.listener.heard(data)[:, -len(self.output.bands.window) :])

    def observe(self, sample: Sample) -> Observation:
        """Return the sample within its bounds."""
        return {"hearing": sample.clip(self.output.low, self.output.high).astype(np.float32)}

    def play(self, pressure_pa: Any, rate_hz: float, point_m: Sequence[float], body: int, data: mujoco.MjData) -> None:
        """Let a recorded sound begin now; see `mimoc.InfantEnv.play`."""
        self.listener.play(*checked_playback(pressure_pa, rate_hz, point_m), body, data.time)

    def listen_to(self, sources: SoundSources, voice: Voice | None = None, others: Sequence[Voice] = ()) -> None:
        """Hear companions, the infant's own voice, and those of others."""
        self.listener.listen_to(sources, voice, others)


def bind(entry: HearingEntry, model: mujoco.MjModel, bundle: Bundle) -> Hearing:
    """Return the ears of *entry* in *model*."""
    rate_hz = entry.sample_rate_hz
    samples_per_step = round(rate_hz * ms_to_s(bundle.manifest.step_ms))
    window: Any = np.ones(samples_per_step)
    if entry.output != "waveform":
        window = np.hanning(round(WINDOW_S * rate_hz) + 2)[1:-1]
    centres_hz = band_centres_hz(entry.channels, rate_hz)
    thresholds_db = thresholds_at(centres_hz, entry.threshold_hz, entry.threshold_db)
    output = OUTPUTS[entry.output](Bands(centres_hz, rate_hz, window), thresholds_db, bool(entry.threshold_hz))
    # Two samples of the sense can be this many samples of sound apart.
    kept_samples = max(2 * samples_per_step, len(window))
    return Hearing(output, Listener(entry, model, bundle, kept_samples), model.body(entry.head).id)


@dataclass(frozen=True)
class LevelNoise(Noise):
    """Adds noise to the level of each band that is heard; where nothing is heard, there is none."""

    deviation_db: FloatArray  # Standard deviation of a level, shape (1,).

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return a sample with noise, shape (k, 2, channels), and no state."""
        heard = sample > 0
        noisy_db = sample + self.deviation_db[..., None] * draw.normals(sample.shape, heard)
        return draw.xp.where(heard, draw.xp.maximum(noisy_db, 0.0), 0.0), None


@dataclass(frozen=True)
class GainNoise(Noise):
    """Changes the level of the whole sound at each ear, from one sample of the sense to the next."""

    deviation_db: FloatArray  # Standard deviation of the level, shape (1,).

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return a sample with noise, shape (k, 2, samples), and no state."""
        gains_db = self.deviation_db[..., None] * draw.normals((*sample.shape[:2], 1))
        return sample * 10 ** (gains_db / 20), None


def bind_noise(amount_db: float, sense: Hearing, low_pass_s: float) -> LevelNoise | GainNoise:
    """Return the noise of a sense of hearing."""
    kind = GainNoise if isinstance(sense.output, Waveform) else LevelNoise
    return kind(np.array([amount_db]))

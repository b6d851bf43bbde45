"""Frequency bands of the ear: from sound pressure to the level of each band, in dB.

The n-th band is a gammatone filter of fourth order about a frequency f_n (Patterson et al. 1992), whose width is that
of adults' auditory filters, ERB(f) = 24.7 (4.37 f / 1000 + 1) in [Hz] (Glasberg & Moore 1990):

    |G_n(f)|² = (1 + ((f - f_n) / (1.019 ERB(f_n)))²)⁻⁴.

Its level is 10 log10(Σ |X(f)|² |G_n(f)|² / p₀²) over the spectrum X of a window of time, so that a lasting tone of that
frequency has its sound pressure level there, re p₀ = 20 µPa. Infants' filters are as wide as adults' here; theirs are
so from 6 months on (Spetner & Olsho 1990, from memory).
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

REFERENCE_PA = 20e-6  # p₀.
LOWEST_HZ, HIGHEST_HZ = 100.0, 8000.0  # Of the lowest and the highest band.
HIGHEST_SHARE = 0.9  # The highest band is below this share of half the sample rate.
WIDTH = 1.019
ORDER = 4
SILENCE = 1e-30  # Mean square that stands for none.


def erb_hz(frequency_hz: Any) -> Any:
    """Return the equivalent rectangular bandwidth of the auditory filter about a frequency (Glasberg & Moore 1990).

    Example:
        >>> from mimoc.components.senses.hearing.cochlea import erb_hz
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
        """From power by frequency to mean square pressure by band, shape (frequencies, channels)."""
        size = len(self.window)
        frequencies_hz = np.fft.rfftfreq(size, 1 / self.sample_rate_hz)[:, None]
        off = (frequencies_hz - self.centres_hz) / (WIDTH * erb_hz(self.centres_hz))
        weights = (1 + off * off) ** -float(ORDER)
        times_s = np.arange(size) / self.sample_rate_hz
        phases = 2 * np.pi * (self.centres_hz[:, None, None] * times_s + np.array([[0.0], [0.25]]))
        tones = np.abs(np.fft.rfft(np.cos(phases) * self.window)) ** 2  # Two in quadrature, as phase matters if short.
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

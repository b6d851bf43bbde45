"""Bands are as wide as auditory filters, and a tone has its sound pressure level in its own."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from mimoc.components.senses.hearing.run import OUTPUTS, Bands, band_centres_hz, erb_hz, thresholds_at

RATE_HZ = 24_000
HANN = np.hanning(602)[1:-1]


def tone(hz: float, level_db: float, samples: int, phase: float = 0.0) -> np.ndarray:
    """Return a tone of some level at both ears, shape (2, samples)."""
    amplitude_pa = np.sqrt(2) * 20e-6 * 10 ** (level_db / 20)
    wave = amplitude_pa * np.sin(2 * np.pi * hz * np.arange(samples) / RATE_HZ + phase)
    return np.stack([wave, wave])


def test_bandwidths_are_those_of_glasberg_and_moore():
    assert erb_hz(1000.0) == pytest.approx(132.6, abs=0.1)
    assert erb_hz(100.0) == pytest.approx(35.5, abs=0.1)


@pytest.mark.parametrize("rate_hz", [8000, 24_000, 48_000])
def test_centres_are_equally_many_bandwidths_apart(rate_hz):
    centres_hz = band_centres_hz(32, rate_hz)
    apart = np.diff(centres_hz) / erb_hz((centres_hz[1:] + centres_hz[:-1]) / 2)
    assert apart == pytest.approx(apart.mean(), rel=0.01)
    assert centres_hz[0] == pytest.approx(100)
    assert centres_hz[-1] == pytest.approx(min(8000, 0.9 * rate_hz / 2))


@given(st.integers(0, 31), st.floats(0, 120), st.floats(0, 2 * np.pi))
def test_a_lasting_tone_has_its_level_in_its_band_and_less_in_the_others(band, level_db, phase):
    bands = Bands(band_centres_hz(32, RATE_HZ), RATE_HZ, HANN)
    levels_db = bands.levels_db(tone(bands.centres_hz[band], level_db, len(HANN), phase))
    assert levels_db[0, band] == pytest.approx(level_db, abs=0.3)
    assert levels_db[0].argmax() == band


@pytest.mark.parametrize("output", OUTPUTS)
@pytest.mark.parametrize("band", [3, 10, 20, 31])
def test_a_staircase_of_tones_ends_at_the_threshold_that_was_entered(output, band):
    """One up, one down, as clinics do it: within 10 % of the threshold, and within 1 dB of low ones."""
    centres_hz = band_centres_hz(32, RATE_HZ)
    thresholds_db = np.linspace(45, 25, 32)
    window = np.ones(240) if output == "waveform" else HANN
    hears = OUTPUTS[output](Bands(centres_hz, RATE_HZ, window), thresholds_db, True)
    level_db, step_db, turns, went_up = 70.0, 4.0, [], False
    while len(turns) < 10:
        is_heard = hears(tone(centres_hz[band], level_db, len(window))).any()
        if is_heard == went_up:
            turns.append(level_db)
            step_db = max(step_db / 2, 0.25)
        went_up = not is_heard
        level_db += step_db if went_up else -step_db
    assert np.mean(turns[-6:]) == pytest.approx(thresholds_db[band], rel=0.1)


def test_without_a_table_the_threshold_is_0_db_and_with_one_it_is_the_tables():
    assert (thresholds_at(np.array([100.0, 1000.0]), (), ()) == 0).all()
    assert thresholds_at(np.array([500.0, 707.1, 1000.0]), (500, 1000), (30, 20)) == pytest.approx(
        [30, 25, 20], abs=0.01
    )

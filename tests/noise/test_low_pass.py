"""Noise that changes gradually has the mean, the deviation and the time constant that it says."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mimoc.noise.low_pass import LowPassed, Smooth

COUNT = 40_000
TOLERANCE = 5 / math.sqrt(COUNT)
"""Five standard errors of a mean."""

times_s = st.floats(1e-4, 0.5)
seeds = st.integers(0, 2**32)


def generator(seed: int) -> np.random.Generator:
    return np.random.default_rng(seed)


@settings(max_examples=20)
@given(times_s, times_s, seeds)
def test_values_correlate_by_the_time_between_them_however_it_is_divided(elapsed_s, constant_s, seed):
    noise, draws = LowPassed(COUNT, constant_s), generator(seed)
    before = noise.advance(math.inf, draws)
    noise.advance(elapsed_s / 3, draws)
    after = noise.advance(elapsed_s * 2 / 3, draws)
    for values in (before, after):
        assert abs(values.mean()) < TOLERANCE
        assert values.var() == pytest.approx(1, abs=2 * TOLERANCE)
    assert (before * after).mean() == pytest.approx(math.exp(-elapsed_s / constant_s), abs=2 * TOLERANCE)


@settings(max_examples=20)
@given(times_s, times_s, seeds)
def test_smooth_noise_keeps_its_deviation_and_that_of_its_rate(elapsed_s, constant_s, seed):
    noise, draws = Smooth(COUNT, constant_s), generator(seed)
    noise.advance(math.inf, draws)
    values, rates_per_s = noise.advance(elapsed_s, draws)
    assert abs(values.mean()) < TOLERANCE
    assert values.var() == pytest.approx(1, abs=2 * TOLERANCE)
    assert (constant_s * rates_per_s).var() == pytest.approx(1, abs=2 * TOLERANCE)
    assert (constant_s * values * rates_per_s).mean() == pytest.approx(0, abs=2 * TOLERANCE)


def test_the_rate_of_smooth_noise_is_its_derivative():
    """Over a tenth of a second, by the trapezoidal rule."""
    noise, draws, step_s = Smooth(50, 0.06), generator(0), 0.0001
    steps = [noise.advance(math.inf, draws), *(noise.advance(step_s, draws) for _ in range(1000))]
    values, rates_per_s = (np.array(found) for found in zip(*steps, strict=True))
    walked = step_s * (rates_per_s[1:] + rates_per_s[:-1]).sum(axis=0) / 2
    assert walked == pytest.approx(values[-1] - values[0], abs=0.01)


def test_every_value_is_independent_of_the_others():
    noise, draws = LowPassed(4, 0.06), generator(1)
    noise.advance(math.inf, draws)
    found = np.array([noise.advance(0.06, draws) for _ in range(COUNT)])
    assert np.corrcoef(found.T) == pytest.approx(np.eye(4), abs=3 * TOLERANCE)

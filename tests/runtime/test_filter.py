"""Filters of senses: exact between samples, whenever these are taken."""

import array_api_strict as strict
import numpy as np
import pytest
from hypothesis import given, strategies as st

from mimoc.runtime.filter import Lags, lags_of
from mimoc.runtime.term import stack_terms
from mimoc.runtime.worlds import NUMPY

seconds = st.floats(0.01, 100.0)


def run(lags: Lags, times_s: np.ndarray, inputs: np.ndarray) -> np.ndarray:
    """Return the responses of one infant, shape (times, n)."""
    stacked, state, responses = stack_terms([lags]), None, []
    for elapsed_s, sample in zip(np.diff(times_s, prepend=times_s[0]), inputs, strict=True):
        response, state = stacked(NUMPY, float(elapsed_s), sample[None], state)
        responses.append(response[0])
    return np.array(responses)


@given(seconds, seconds)
def test_a_ramp_is_filtered_exactly_however_seldom_it_is_sampled(slow_s, end_s):
    """The response of T s / (1 + T s) to a ramp t, from rest, is T (1 - exp(-t / T))."""
    lags = lags_of(1, (slow_s,))
    times_s = np.sort(np.random.default_rng(0).uniform(0, end_s, 7))
    times_s[0] = 0.0
    felt = run(lags, times_s, times_s[:, None])[:, 0]
    assert felt == pytest.approx(slow_s * -np.expm1(-times_s / slow_s), rel=1e-6, abs=1e-9)


@given(st.lists(st.floats(0.05, 50), min_size=2, max_size=3, unique=True), st.floats(0.01, 5))
def test_partial_fractions_are_the_product_of_high_passes(high_passes_s, frequency_hz):
    if min(abs(a / b - 1) for a in high_passes_s for b in high_passes_s if a != b) < 1e-3:
        return
    lags, s = lags_of(1, high_passes_s), 2j * np.pi * frequency_hz
    wanted = np.prod([time_s * s / (1 + time_s * s) for time_s in high_passes_s])
    gained = lags.direct + (lags.weights / (1 + lags.time_constants_s * s)).sum()
    assert gained == pytest.approx([wanted], rel=1e-6, abs=1e-9)


def test_many_infants_with_other_time_constants_are_each_filtered_as_one():
    terms = [lags_of(3, (time_s, 80.0), first=1) for time_s in (4.0, 6.0, 15.0)]
    samples, states = np.random.default_rng(1).normal(size=(5, 3, 3)), None
    single = [run(term, np.arange(5) * 0.01, samples[:, index]) for index, term in enumerate(terms)]
    together = stack_terms(terms)
    for number, sample in enumerate(samples):
        felt, states = together(NUMPY, 0.01, sample, states)
        assert felt == pytest.approx(np.array([one[number] for one in single]), rel=1e-12)


def test_lags_are_the_same_by_the_array_api():
    term = lags_of(4, (80.0, 5.7), (0.049,), (0.003,), first=1)
    samples, states, others = np.random.default_rng(2).normal(size=(4, 2, 4)), None, None
    plain, standard = stack_terms([term] * 2), stack_terms([term] * 2, strict.asarray)
    for sample in samples:
        felt, states = plain(NUMPY, 0.01, sample, states)
        again, others = standard(strict, 0.01, strict.asarray(sample), others)
        assert np.asarray(again) == pytest.approx(felt, rel=1e-12)

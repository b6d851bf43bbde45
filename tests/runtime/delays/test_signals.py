"""Signals with a delay come out in their order, as many items later as the delay has control steps."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from mimoc.runtime.delays.signals import Delay, DelayedSamples
from mimoc.runtime.noise import NoiseStreams

PERIOD = 2


def line(length, sample):
    samples = DelayedSamples(Delay(length * PERIOD), PERIOD)
    samples.reset(sample)
    return samples


def sent(samples, items):
    arrived = []
    for item in items:
        samples.send(item)
        arrived.append(samples.arrived)
    return arrived


@given(st.integers(0, 20), st.lists(st.integers(), max_size=50))
def test_what_goes_in_comes_out_that_much_later(length, items):
    assert sent(line(length, "rest"), items) == (["rest"] * length + items)[: len(items)]


@given(st.integers(0, 5), st.lists(st.integers(), max_size=10), st.lists(st.integers(), max_size=10))
def test_a_line_goes_on_from_what_another_held(length, before, after):
    one, other = line(length, 0), line(length, -1)
    sent(one, before)
    other.state = one.state
    assert sent(one, after) == sent(other, after)


def test_a_state_is_a_list_of_its_own():
    samples = line(2, "rest")
    samples.state[0].clear()
    assert samples.state[0] == ["rest"] * 3


LONG = 30_000


@settings(max_examples=30)
@given(st.integers(1, 12), st.integers(0, 2**32), st.lists(st.integers(1, 20), min_size=1, max_size=20))
def test_it_keeps_within_its_bounds_and_changes_by_a_step_at_most(most, seed, parts):
    delay = Delay(most, most, NoiseStreams(seed), "jitter.touch")
    delay.reset()
    found = [delay.deviation, *(value - most for part in parts for value in delay.advance(part))]
    assert len(found) == 1 + sum(parts)
    assert max(map(abs, found)) <= most
    assert np.abs(np.diff(found)).max() <= 1


@pytest.mark.parametrize("most", [1, 2, 4])
def test_all_deviations_are_equally_likely_so_that_the_mean_is_zero(most):
    delay = Delay(most, most, NoiseStreams(0), "jitter.touch")
    delay.reset()
    counts = np.bincount(np.array(delay.advance(LONG)), minlength=2 * most + 1)
    assert counts / LONG == pytest.approx(1 / (2 * most + 1), rel=0.15)


def test_it_begins_anywhere():
    streams = NoiseStreams(0)
    delay, begun = Delay(2, 2, streams, "jitter.touch"), set()
    for _ in range(100):
        delay.reset()
        begun.add(delay.deviation)
    assert begun == {-2, -1, 0, 1, 2}

"""A delay varies between its bounds: every value is as likely as another, and time never runs backwards."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from mimoc.delays.signals import Delay
from mimoc.noise.noise import NoiseStreams

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

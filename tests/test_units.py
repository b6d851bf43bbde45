import math

import pytest
from hypothesis import given, strategies as st

from mimoc.base.rounding import rounded
from mimoc.base.units import cm_to_m, deg_to_rad, m_to_cm, months_to_days, ms_to_s, to_steps


def test_what_a_spec_says_in_si():
    assert cm_to_m(46.8) == pytest.approx(0.468)
    assert deg_to_rad(180) == pytest.approx(math.pi)
    assert ms_to_s(5) == 0.005


@given(length_cm=st.floats(0, 1e6))
def test_centimetres_come_back(length_cm):
    assert m_to_cm(cm_to_m(length_cm)) == pytest.approx(length_cm)


def test_months_are_whos():
    """WHO's tables run to day 1856 and count 30.4375 days a month."""
    assert months_to_days(24) == 730.5
    assert months_to_days(1) == 30.4375


@given(steps=st.integers(0, 10_000), timestep_ms=st.floats(0.1, 20))
def test_whole_steps_are_counted(steps, timestep_ms):
    """Also of times as they stand in a bundle: a third of a millisecond is no whole part of a second there."""
    assert to_steps(steps * timestep_ms, timestep_ms) == steps
    assert to_steps(rounded(steps * timestep_ms), rounded(timestep_ms)) == steps


@pytest.mark.parametrize(
    ("time_ms", "timestep_ms", "message"),
    [
        (12, 5, "12 ms is 2.40 steps of 5 ms; the nearest that works is 10 ms"),
        (13, 5, "13 ms is 2.60 steps of 5 ms; the nearest that works is 15 ms"),
        (3, 2.5, "3 ms is 1.20 steps of 2.5 ms; the nearest that works is 2.5 ms"),
    ],
)
def test_a_time_between_steps_is_refused_with_the_nearest(time_ms, timestep_ms, message):
    with pytest.raises(ValueError, match=message):
        to_steps(time_ms, timestep_ms)

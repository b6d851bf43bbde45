from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st

from mimoc.fits import load_tables
from mimoc.fits.curves import B_MAX_MONTHS, B_MIN_MONTHS, LAST_MONTH, LogCurve, fit_count_curve, fit_log_curve
from mimoc.fits.growth import fit_growth

AGES_MONTHS = (0.0, 1.5, 4.5, 7.5, 10.5, 14.0, 18.0, 22.0, 33.0)

measured_cm = st.lists(st.floats(1, 100), min_size=len(AGES_MONTHS), max_size=len(AGES_MONTHS))


def squares(curve: LogCurve, values: list[float]) -> float:
    return float(sum((curve(age) - value) ** 2 for age, value in zip(AGES_MONTHS, values, strict=True)))


def best_with_shift(b_months: float, values: list[float]) -> LogCurve:
    a, c = np.polyfit(np.log(np.array(AGES_MONTHS) + b_months), values, 1)
    return LogCurve(float(a), b_months, float(c))


@given(a=st.floats(0.1, 20), b_months=st.floats(B_MIN_MONTHS, 60), c=st.floats(-20, 60))
def test_an_exact_log_curve_is_recovered(a, b_months, c):
    true = LogCurve(a, b_months, c)
    found = fit_log_curve(AGES_MONTHS, [true(age) for age in AGES_MONTHS])
    assert [found(age) for age in range(25)] == pytest.approx([true(age) for age in range(25)], abs=1e-5)
    assert found.b_months == pytest.approx(b_months, rel=1e-3)


@given(values=measured_cm, factor=st.floats(0.9, 1.1), a=st.floats(-0.1, 0.1), c=st.floats(-0.1, 0.1))
def test_no_nearby_shift_slope_or_offset_fits_better(values, factor, a, c):
    """Also with the best a and c for that shift; at the limits of b there is no neighbour on one side."""
    found = fit_log_curve(AGES_MONTHS, values)
    b_months = min(max(found.b_months * factor, B_MIN_MONTHS), B_MAX_MONTHS)
    assert squares(found, values) <= squares(best_with_shift(b_months, values), values) + 1e-6
    other = LogCurve(found.a + a, found.b_months, found.c + c)
    assert squares(found, values) <= squares(other, values) + 1e-6


@given(values=measured_cm)
def test_the_shift_stays_within_its_limits(values):
    """At least 0.1 months, so that the curve is finite at birth (paper, eq. 1)."""
    found = fit_log_curve(AGES_MONTHS, values)
    assert B_MIN_MONTHS * (1 - 1e-9) <= found.b_months <= B_MAX_MONTHS * (1 + 1e-9)
    assert np.isfinite(found(0))


@given(values=measured_cm, order=st.permutations(range(len(AGES_MONTHS))))
def test_the_order_of_the_points_does_not_matter(values, order):
    found = fit_log_curve(AGES_MONTHS, values)
    shuffled = fit_log_curve([AGES_MONTHS[i] for i in order], [values[i] for i in order])
    assert squares(shuffled, values) == pytest.approx(squares(found, values), rel=1e-6, abs=1e-9)


def test_equal_values_give_a_flat_curve():
    found = fit_log_curve(AGES_MONTHS, [7.0] * len(AGES_MONTHS))
    assert [found(age) for age in AGES_MONTHS] == pytest.approx([7.0] * len(AGES_MONTHS))


def test_straight_growth_is_fitted_by_a_large_shift():
    found = fit_log_curve(AGES_MONTHS, [10 + 0.5 * age for age in AGES_MONTHS])
    assert found(12) == pytest.approx(16, abs=0.02)


EVEN = [1.0] * len(AGES_MONTHS)


@given(a=st.floats(1, 20), b_months=st.floats(0.3, 10), c=st.floats(-20, 60), d=st.floats(0, 1))
def test_an_exact_curve_with_a_steady_part_is_recovered(a, b_months, c, d):
    true = LogCurve(a, b_months, c, d)
    found = fit_count_curve(AGES_MONTHS, [true(age) for age in AGES_MONTHS], EVEN)
    assert [found(age) for age in range(25)] == pytest.approx([true(age) for age in range(25)], abs=1e-3)


@given(a=st.floats(0.5, 20), b_months=st.floats(0.3, 50), noise=st.lists(st.floats(-0.3, 0.3), min_size=9, max_size=9))
def test_no_curve_with_a_steady_part_falls_before_two_years(a, b_months, noise):
    true = LogCurve(a, b_months, 10.0)
    values = [true(age) + error for age, error in zip(AGES_MONTHS, noise, strict=True)]
    found = fit_count_curve(AGES_MONTHS, values, EVEN)
    heights = [found(quarter / 4) for quarter in range(4 * int(LAST_MONTH) + 1)]
    assert all(after >= before - 1e-9 for before, after in pairwise(heights))


def test_values_that_fall_give_their_mean():
    found = fit_count_curve(AGES_MONTHS, [20 - 0.1 * age for age in AGES_MONTHS], EVEN)
    assert [found(0), found(24)] == pytest.approx([20 - 0.1 * np.mean(AGES_MONTHS)] * 2)


def test_a_point_of_little_weight_moves_the_curve_little():
    values = [10 + 2 * np.log(age + 1) for age in AGES_MONTHS[:-1]] + [40.0]
    light, heavy = (fit_count_curve(AGES_MONTHS, values, [*EVEN[:-1], weight]) for weight in (1e-6, 1.0))
    assert abs(light(18) - values[6]) < 0.01 < abs(heavy(18) - values[6])


@pytest.mark.parametrize("law", ["paper", "count"])
def test_the_last_bits_of_logarithms_and_sums_change_no_coefficient(law, monkeypatch):
    """They depend on the processor, on NumPy and on the system's mathematical library."""
    expected = fit_growth(load_tables(), law=law)
    generator, log1p, log = np.random.default_rng(0), np.log1p, np.log

    def noisy(function):
        def other(x):
            exact = function(x)
            return np.nextafter(exact, exact + generator.choice([-1.0, 0.0, 1.0], np.shape(exact)))

        return other

    monkeypatch.setattr(np, "log1p", noisy(log1p))
    monkeypatch.setattr(np, "log", noisy(log))
    for _ in range(3):
        assert fit_growth(load_tables(), law=law) == expected

import math

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st

from mimoc.base.units import DAYS_PER_MONTH
from mimoc.fits import load_tables
from mimoc.fits.standards import REFERENCES, SEXES, GrowthStandard, percentile

WHO = load_tables().who

standards = st.sampled_from(sorted(WHO)).map(WHO.__getitem__)
references = st.sampled_from(REFERENCES)
ages_months = st.floats(0, 24)
z_scores = st.floats(-5, 5)


@given(standard=standards, age_months=ages_months, reference=references, z=z_scores, ratio=st.floats(0.6, 1.6))
def test_value_and_z_score_undo_each_other(standard, age_months, reference, z, ratio):
    value = standard.value(z, age_months, reference)
    assert standard.z_score(value, age_months, reference) == pytest.approx(z, abs=1e-9)
    value = ratio * standard.value(0, age_months, reference)
    assert standard.value(standard.z_score(value, age_months, reference), age_months, reference) == pytest.approx(value)


@given(standard=standards, age_months=ages_months, reference=references, z=z_scores, more=st.floats(1e-6, 3))
def test_more_is_a_higher_z_score(standard, age_months, reference, z, more):
    assert standard.value(z, age_months, reference) < standard.value(z + more, age_months, reference)


@given(standard=standards, sex=st.sampled_from(SEXES), data=st.data())
def test_medians_have_z_score_zero(standard, sex, data):
    day, _, median, _ = data.draw(st.sampled_from(standard.tables[sex].tolist()))
    assert standard.z_score(median, day / DAYS_PER_MONTH, sex) == pytest.approx(0, abs=1e-9)


@given(standard=standards, age_months=ages_months, z=st.floats(-3, 3))
def test_the_mean_child_lies_between_boys_and_girls(standard, age_months, z):
    """To a hundredth: where their curves cross far from the median, the mean curve misses the crossing."""
    boys, girls, mean = (standard.value(z, age_months, reference) for reference in ("male", "female", "mean"))
    assert 0.99 * min(boys, girls) <= mean <= 1.01 * max(boys, girls)


@given(standard=standards, age_months=ages_months)
def test_the_mean_median_is_the_mean_of_the_medians(standard, age_months):
    boys, girls, mean = (standard.value(0, age_months, reference) for reference in ("male", "female", "mean"))
    assert mean == pytest.approx((boys + girls) / 2)


@given(standard=standards, reference=references, younger=ages_months, older=ages_months)
def test_medians_grow(standard, reference, younger, older):
    """But for weight, which newborns lose in their first days."""
    younger, older = sorted((younger, older))
    assume(younger > 0.25 or standard is not WHO["weight_kg"])
    assert standard.value(0, younger, reference) <= standard.value(0, older, reference) + 1e-9


@pytest.mark.parametrize(
    ("indicator", "age_months", "sex", "z", "value"),
    [
        ("length_cm", 0, "male", 0, 49.8842),
        ("length_cm", 0, "female", 0, 49.1477),
        ("length_cm", 0, "male", 2, 53.7),
        ("length_cm", 12, "female", -2, 68.9),
        ("length_cm", 24, "male", 0, 87.8),
        ("weight_kg", 0, "male", 0, 3.3464),
        ("weight_kg", 12, "male", 0, 9.6),
        ("weight_kg", 12, "male", 3, 13.3),
        ("weight_kg", 24, "female", -3, 8.1),
        ("head_circumference_cm", 0, "female", 0, 33.9),
        ("head_circumference_cm", 24, "male", 0, 48.3),
        ("arm_circumference_cm", 3, "male", 0, 13.5),
        ("arm_circumference_cm", 12, "female", 0, 14.2),
    ],
)
def test_values_are_those_that_who_prints(indicator, age_months, sex, z, value):
    """WHO's simplified field tables, to the digits that they show."""
    assert WHO[indicator].value(z, age_months, sex) == pytest.approx(value, abs=0.051)


def test_mean_newborns_are_who_mean_newborns():
    assert WHO["length_cm"].value(0, 0, "mean") == pytest.approx(49.516, abs=1e-3)
    assert WHO["head_circumference_cm"].value(0, 0, "mean") == pytest.approx(34.170, abs=1e-3)


def test_z_score_is_the_box_cox_transform_of_who():
    """The formula of WHO's report, at 1 year: L, M and S of boys' weight."""
    _, power, median, variation = WHO["weight_kg"].tables["male"][365]
    expected = ((11.0 / median) ** power - 1) / (power * variation)
    assert WHO["weight_kg"].z_score(11.0, 365 / DAYS_PER_MONTH, "male") == pytest.approx(expected)


@pytest.mark.parametrize("side", [-1, 1])
def test_beyond_three_deviations_z_scores_count_the_third(side):
    """WHO 2006, section 7: as far again as from the second to the third deviation is one more."""
    weight = WHO["weight_kg"]
    two, three = (weight.value(side * z, 9, "male") for z in (2, 3))
    assert weight.z_score(three + (three - two), 9, "male") == pytest.approx(side * 4)


def test_a_power_of_zero_is_the_logarithm():
    lognormal = GrowthStandard({sex: np.array([[0.0, 0.0, 10.0, 0.1]]) for sex in SEXES})
    assert lognormal.value(1, 0, "male") == pytest.approx(10 * math.exp(0.1))
    assert lognormal.z_score(10 * math.exp(0.1), 0, "mean") == pytest.approx(1)


@given(z=st.floats(-3, 3))
def test_a_power_near_zero_is_near_the_logarithm(z):
    near, at = (GrowthStandard({sex: np.array([[0.0, power, 10.0, 0.1]]) for sex in SEXES}) for power in (1e-13, 0.0))
    assert near.value(z, 0, "male") == pytest.approx(at.value(z, 0, "male"), rel=1e-9)


@pytest.mark.parametrize("indicator", sorted(WHO))
def test_two_years_count_as_the_last_day(indicator):
    """24 months are 730.5 days; the tables end at 730."""
    standard = WHO[indicator]
    assert standard.value(1, 24, "mean") == standard.value(1, 730 / DAYS_PER_MONTH, "mean")


def test_ages_between_days_are_interpolated():
    length = WHO["length_cm"]
    before, between, after = (length.value(0, day / DAYS_PER_MONTH, "female") for day in (100, 100.5, 101))
    assert between == pytest.approx((before + after) / 2)


def test_arm_circumference_is_known_from_three_months():
    arm = WHO["arm_circumference_cm"]
    assert arm.first_day == 91
    assert arm.covers(3)
    assert not arm.covers(2.9)
    assert all(WHO[indicator].covers(0) for indicator in WHO if indicator != "arm_circumference_cm")


def test_percentiles_are_those_of_the_normal_distribution():
    assert percentile(0) == 50
    assert percentile(1.6448536) == pytest.approx(95)
    assert percentile(-1) + percentile(1) == pytest.approx(100)

"""Children drawn from WHO's standards."""

from statistics import NormalDist

import numpy as np
import pytest
from hypothesis import given, strategies as st

from mimoc.body.measurements import targets
from mimoc.fits import load_tables
from mimoc.schema.cohort_file import DrawnChildren
from mimoc.studies.cohorts.infants import CORRELATIONS, FAT_BUILD, PERCENTILES, RATE_SD, build_z, draw_children

MANY = 2000
Z = {"length_cm": 0, "weight_kg": 1, "head_circumference_cm": 2}


@pytest.fixture(scope="module")
def population():
    return draw_children(DrawnChildren(draw=MANY, seed=3))


@pytest.mark.parametrize("age_months", [0, 2, 9, 24])
@pytest.mark.parametrize("sex", ["female", "male"])
def test_the_drawn_population_has_the_means_and_deviations_of_who(population, age_months, sex):
    """At every age, in the transformed measures in which WHO's distributions are normal; within 4 standard errors."""
    children = [targets(child, age_months) for child in population if child.sex == sex]
    measures = {
        "length_cm": [100 * child.length_m for child in children],
        "weight_kg": [child.weight_kg for child in children],
        "head_circumference_cm": [100 * child.head_m for child in children],
    }
    for indicator, values in measures.items():
        z = np.array([load_tables().who[indicator].z_score(value, age_months, sex) for value in values])
        assert abs(z.mean()) < 4 / np.sqrt(len(z)), indicator
        assert z.std() == pytest.approx(1, abs=4 / np.sqrt(2 * len(z))), indicator


@pytest.mark.parametrize("sex", ["female", "male"])
def test_the_drawn_population_has_the_median_and_the_spread_of_who_in_centimetres(population, sex):
    lengths_cm = [100 * targets(child, 12).length_m for child in population if child.sex == sex]
    standard = load_tables().who["length_cm"]
    median, above = standard.value(0, 12, sex), standard.value(1, 12, sex)
    assert np.mean(lengths_cm) == pytest.approx(median, abs=4 * (above - median) / np.sqrt(len(lengths_cm)))
    assert np.std(lengths_cm) == pytest.approx(above - median, rel=0.07)


def test_length_weight_and_head_are_correlated_as_documented(population):
    z = [scores(population, name) for name in PERCENTILES]
    assert np.corrcoef(z) == pytest.approx(CORRELATIONS, abs=0.06)


@given(st.integers(1, 30), st.integers(0, 2**32 - 1))
def test_a_child_is_the_same_however_many_are_drawn(number, seed):
    few, more = (draw_children(DrawnChildren(draw=count, seed=seed)) for count in (number, number + 3))
    assert more[:number] == few


def test_girls_and_boys_take_turns_and_seeds_differ():
    assert [child.sex for child in draw_children(DrawnChildren(draw=4))] == ["female", "male", "female", "male"]
    assert {child.sex for child in draw_children(DrawnChildren(draw=4, sex="male"))} == {"male"}
    assert draw_children(DrawnChildren(draw=1)) != draw_children(DrawnChildren(draw=1, seed=1))


def test_what_else_differs_is_drawn_after_the_size(population):
    """Child 0 of seed 1 has had these percentiles from the first release on."""
    sizes = draw_children(DrawnChildren(draw=MANY, seed=3, sizes_only=True))
    kept = {"fat_percentile", "maturation_rate"}
    assert [child.model_dump(exclude=kept) for child in population] == [
        child.model_dump(exclude=kept) for child in sizes
    ]
    assert all(child.fat_percentile is None and child.maturation_rate is None for child in sizes)
    (first,) = draw_children(DrawnChildren(draw=1, seed=1, sizes_only=True))
    assert (first.length_percentile, first.weight_percentile) == (59.9782018, 97.5737518)


def test_fat_goes_with_weight_for_length_and_the_rate_with_nothing(population):
    z = {name: scores(population, name) for name in (*PERCENTILES, "fat_percentile")}
    build = build_z(z["length_percentile"], z["weight_percentile"])
    rate = np.log([child.maturation_rate for child in population])
    margin = 4 / np.sqrt(MANY)
    assert np.corrcoef(z["fat_percentile"], build)[0, 1] == pytest.approx(FAT_BUILD, abs=margin)
    assert abs(np.corrcoef(z["fat_percentile"], z["length_percentile"])[0, 1]) < margin
    for other in (*z.values(), [child.sex == "male" for child in population]):
        assert abs(np.corrcoef(rate, other)[0, 1]) < margin
    assert np.std(rate) == pytest.approx(RATE_SD, rel=0.07)
    assert np.mean(np.exp(-rate)) == pytest.approx(1, abs=4 * RATE_SD / np.sqrt(MANY))


def scores(population, name):
    """Return the z-scores of the percentiles of some name."""
    return np.array([NormalDist().inv_cdf(getattr(child, name) / 100) for child in population])

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.optimize import curve_fit

from mimoc.base.errors import DataError
from mimoc.base.units import cm_to_m
from mimoc.fits import load_tables, measure
from mimoc.fits.curves import B_MAX_MONTHS, B_MIN_MONTHS
from mimoc.fits.growth import BIRTH, fit_growth

FINGERS = ("middle_finger_diameter", "thumb_diameter")  # Known by their published coefficients only.

QUARTER_MONTHS = [quarter / 4 for quarter in range(97)]

ages_months = st.floats(0, 24)


@pytest.mark.parametrize("name", sorted(load_tables().published.keys() - FINGERS))
def test_published_group_ages_reproduce_the_published_fits(name):
    """MIMo v2's own curves, within 1e-3 cm from birth to two years."""
    curve, _ = fit_growth(load_tables(), "published", "paper")[name]
    published = load_tables().published[name]
    for age_months in QUARTER_MONTHS:
        assert curve(age_months) == pytest.approx(published(age_months), abs=1e-3)


def test_published_placement_infers_nothing():
    fits = fit_growth(load_tables(), "published", "paper")
    assert len(fits.keys() & load_tables().published.keys() & load_tables().anthrokids.keys()) == 16
    for _, points in fits.values():
        assert min(point.age_months for point in points) == 1
        assert not any(BIRTH in point.origin for point in points)


@given(younger=ages_months, older=ages_months)
def test_no_measurement_ever_decreases(younger, older):
    younger, older = sorted((younger, older))
    before, after = measure(younger), measure(older)
    for name in before:
        assert before[name] <= after[name] * (1 + 1e-12), name


@given(age_months=ages_months)
def test_measurements_are_lengths_of_a_small_child_whose_parts_are_shorter_than_the_whole(age_months):
    child = measure(age_months)
    assert all(0.003 < value_m < 1 for value_m in child.values())
    assert child["crown_rump_length"] < child["crown_sole_length"]
    assert child["hand_length"] < child["elbow_hand_length"]
    assert child["head_breadth"] < child["head_length"]
    assert child["knee_sole_length"] + child["crown_rump_length"] < child["crown_sole_length"]


def test_newborns_are_inferred_from_who():
    """WHO's mean newborn is 49.52 cm long with a head of 34.17 cm."""
    table = measure(0).table
    length, head = table["crown_sole_length"].points[0], table["head_circumference"].points[0]
    assert (length.age_months, length.value_cm) == (0, pytest.approx(49.52, abs=0.005))
    assert (head.age_months, head.value_cm) == (0, pytest.approx(34.17, abs=0.005))


def test_groups_stand_at_the_middle_of_their_months_and_only_inferred_points_are_marked():
    hands = measure(6).table["hand_length"].points
    assert [point.age_months for point in hands] == [0, 1.5, 4.5, 7.5, 10.5, 14, 18, 22, 33]
    for name, measured in measure(6).table.items():
        inferred = [point for point in measured.points if point.origin.startswith(BIRTH)]
        assert [point.age_months for point in inferred] == ([] if name in FINGERS else [0])
        assert all(point.origin.startswith("anthrokids.csv:") for point in measured.points[1:])


def test_newborns_are_the_first_group_made_smaller_but_for_the_head():
    """Isometrically: every other measurement by one factor."""
    shrinks = {
        name: measured.points[0].value_cm / measured.points[1].value_cm
        for name, measured in measure(0).table.items()
        if measured.points
    }
    head = shrinks.pop("head_circumference")
    assert list(shrinks.values()) == pytest.approx([49.52 / 56.3] * len(shrinks), abs=1e-4)
    assert head > max(shrinks.values())


def test_a_measurement_is_read_off_its_curve_in_metres():
    measured = measure(9).table["foot_length"]
    assert measured.value_m == pytest.approx(cm_to_m(measured.curve(9)))
    assert measured.origin == "anthrokids.csv: foot_length, log fit"
    assert measure(9)["foot_length"] == measured.value_m


def test_finger_diameters_come_from_the_published_coefficients():
    child = measure(12)
    for name in FINGERS:
        assert child[name] == pytest.approx(cm_to_m(load_tables().published[name](12)))
        assert child.table[name].origin == f"anthrokids_published_fits.csv: {name}"
        assert child.table[name].points == ()


def test_curves_stay_near_their_points():
    """The survey's means scatter by a few per cent about any smooth curve."""
    for name, (curve, points) in fit_growth(load_tables()).items():
        for point in points:
            assert math.isclose(curve(point.age_months), point.value_cm, rel_tol=0.06), (name, point)


def test_the_papers_law_has_no_steady_part_and_bodies_have():
    for law, has in (("paper", False), ("count", True)):
        assert all(bool(curve.d) == has for curve, _ in fit_growth(load_tables(), law=law).values())
    child = measure(4)
    assert child.table["foot_length"].curve.d != 0
    assert child.paper_law.table["foot_length"].curve.d == 0
    assert child.paper_law.paper_law is child.paper_law


def test_with_a_steady_part_every_group_but_one_is_within_four_percent():
    """The hips of six to eight months are broader than those of nine to eleven."""
    outside = [
        (name, point.age_months)
        for name, (curve, points) in fit_growth(load_tables()).items()
        for point in points
        if 0 < point.age_months < 24 and abs(curve(point.age_months) / point.value_cm - 1) > 0.04
    ]
    assert outside == [("hip_circumference", 7.5)]


def test_two_groups_are_too_few():
    tables = load_tables()
    few = dataclasses.replace(tables, anthrokids={**tables.anthrokids, "nose": tables.anthrokids["hand_length"][:2]})
    with pytest.raises(DataError, match="nose has 2 age groups"):
        fit_growth(few)


@pytest.mark.parametrize("name", sorted(load_tables().anthrokids))
def test_scipy_finds_the_same_curves(name):
    """The search of mimoc's own leaves as little as a general method does, and less where that stops early."""
    curve, points = fit_growth(load_tables(), law="paper")[name]
    ages_months, values_cm = np.array([(point.age_months, point.value_cm) for point in points]).T

    def law(age_months, a, b, c):
        return a * np.log(age_months + b) + c

    bounds = ([-np.inf, B_MIN_MONTHS, -np.inf], [np.inf, B_MAX_MONTHS, np.inf])
    theirs, _ = curve_fit(law, ages_months, values_cm, p0=(1.0, 5.0, values_cm.mean()), bounds=bounds, max_nfev=20_000)
    left, others = (
        np.sum((law(ages_months, *coefficients) - values_cm) ** 2)
        for coefficients in ((curve.a, curve.b_months, curve.c), theirs)
    )
    assert left <= others * (1 + 1e-6) + 1e-9
    if left > others / (1 + 1e-6) - 1e-9:  # It did not stop early.
        assert [curve(age) for age in (0, 6, 24)] == pytest.approx(law(np.array([0, 6, 24]), *theirs), abs=0.02)

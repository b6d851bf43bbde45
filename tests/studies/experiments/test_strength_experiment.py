from functools import cache

import numpy as np
import pytest

from mimoc.studies.experiment import figures_of
from mimoc.studies.experiments.strength import (
    BEHAVIOURS,
    PAPER_MONTHS,
    SIZES,
    TARGET_DEG,
    Effort,
    age_of,
    efforts,
    gets_as_far_with_age,
    is_faster_with_age,
)

HEAD, LEG = BEHAVIOURS
each_behaviour = pytest.mark.parametrize("behaviour", BEHAVIOURS, ids=lambda behaviour: behaviour.name)


@cache
def effort(behaviour, age_months, model="torque") -> Effort:
    return dict(zip(BEHAVIOURS, _efforts(age_months, model), strict=True))[behaviour]


@cache
def _efforts(age_months, model):
    return list(efforts("published", age_months, model))


def moved(angle_deg, behaviour=HEAD) -> Effort:
    return Effort(behaviour, 6.0, 6.0, 65.0, np.array(angle_deg, float), end_deg=81.0)


def paper_s(behaviour, size) -> float:
    (figure,) = (
        item
        for item in figures_of("strength")
        if item.quantity.startswith(f"{behaviour.name} at relative size {size:g},")
    )
    return float(figure.paper)


# The paper's laws.


@pytest.mark.full
@each_behaviour
def test_older_infants_are_faster_to_60_degrees(behaviour):
    found = [effort(behaviour, age_months) for age_months in PAPER_MONTHS]
    times_s = [each.time_to_s(TARGET_DEG) for each in found if each.age_months >= 3]
    assert times_s == sorted(times_s, reverse=True)
    assert times_s[0] > 1.5 * times_s[-1]
    assert is_faster_with_age(found)


@each_behaviour
def test_older_infants_get_at_least_as_far(behaviour):
    found = [effort(behaviour, age_months) for age_months in PAPER_MONTHS]
    assert gets_as_far_with_age(found)
    assert found[0].peak_deg < found[-1].peak_deg - 20


@pytest.mark.parametrize(
    ("behaviour", "size"), [(each, size) for each in BEHAVIOURS for size in SIZES[each.name]], ids=str
)
def test_parts_as_large_as_those_of_mimos_scaled_model_are_about_as_fast(behaviour, size):
    """MIMo v2's body does not grow in proportion: no thigh is as small as .62."""
    age_months = age_of(behaviour, size)
    if age_months is None:
        assert (behaviour, size) == (LEG, 0.62)
    else:
        time_s = effort(behaviour, age_months).time_to_s(TARGET_DEG)
        assert -0.2 < time_s / paper_s(behaviour, size) - 1 < 0


@each_behaviour
def test_a_part_has_full_size_at_18_months(behaviour):
    assert age_of(behaviour, 1.0) == pytest.approx(18)


def test_month_by_month_no_rise_is_as_long_as_a_control_step():
    """Differences below a step depend on when individual contacts break."""
    for behaviour in BEHAVIOURS:
        assert is_faster_with_age([effort(behaviour, age_months) for age_months in range(19, 25)], 0.005)


# How it is measured.


@each_behaviour
def test_it_starts_flat_and_at_rest(behaviour):
    for age_months in (0, 9, 24):
        angle_deg = effort(behaviour, age_months).angle_deg
        assert abs(angle_deg[1] - angle_deg[0]) < 0.5
        assert abs(angle_deg[0]) < 12
        assert len(angle_deg) == 501


def test_the_angle_counts_up_as_the_part_rises():
    assert effort(HEAD, 18).angle_deg[-1] == pytest.approx(81, abs=0.5)
    assert effort(LEG, 18).angle_deg[-1] == pytest.approx(133, abs=0.5)


def test_all_behaviours_start_from_the_same_rest():
    alone = [each.angle_deg for each in efforts("published", 6)][1]
    assert np.array_equal(alone, effort(LEG, 6).angle_deg)


@each_behaviour
def test_muscles_pull_the_same_way(behaviour):
    assert effort(behaviour, 18, "muscle").peak_deg > 80


def test_strength_can_be_that_of_another_age():
    (stronger, _), weaker = efforts("published", 3, strength_age_months=18), effort(HEAD, 3)
    assert stronger.strength_age_months == 18
    assert stronger.time_to_s(TARGET_DEG) < weaker.time_to_s(TARGET_DEG)


def test_time_is_told_between_steps():
    assert moved([0, 59, 61]).time_to_s(60) == pytest.approx(0.0075)
    assert moved([0, 60, 61]).time_to_s(60) == pytest.approx(0.005)
    assert moved([70, 80]).time_to_s(60) == 0
    assert moved([0, 59.9]).time_to_s(60) is None


def test_a_dip_into_the_stop_is_no_farther():
    assert (moved([0, 84]).peak_deg, moved([0, 84]).peak_in_range_deg) == (84, 81)
    assert gets_as_far_with_age([moved([0, 84]), moved([0, 83])])
    assert not gets_as_far_with_age([moved([0, 70]), moved([0, 69])])


def test_never_arriving_is_not_faster():
    assert is_faster_with_age([moved([0, 50, 70]), moved([0, 60, 70])])
    assert not is_faster_with_age([moved([0, 60, 70]), moved([0, 50, 70])])
    assert not is_faster_with_age([moved([0, 60, 70]), moved([0, 50])])
    assert not is_faster_with_age([moved([0, 60, 70]), moved([0, 60, 70])])
    assert is_faster_with_age([moved([0, 60, 70]), moved([0, 60, 70])], within_s=0.001)

"""The search for the age from which on a trial succeeds."""

from itertools import pairwise

import pytest
from hypothesis import given, strategies as st

from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones import TRIALS, Conditions, search_near
from mimoc.studies.milestones.search import AGES, EXPECTED_MONTHS, search, search_downwards, walk
from mimoc.studies.milestones.trial import Outcome


def searched(ages, succeeds):
    """Return the youngest age that a search finds, and the ages that it tried."""
    found = search_downwards(ages, lambda age: Outcome(succeeds(age), 1.0))
    return found.youngest_months, list(found.outcomes)


@given(st.integers(0, 49))
def test_an_infant_that_learns_once_is_found_to_the_half_month(first):
    youngest, tried = searched(AGES, lambda age: age >= 0.5 * first)
    assert youngest == (AGES[first] if first < len(AGES) else None)
    assert 0.0 in tried


@given(st.sets(st.sampled_from(AGES)))
def test_all_older_ages_that_were_tried_succeeded_and_none_is_left_out_for_more_than_a_month(failing):
    youngest, tried = searched(AGES, lambda age: age not in failing)
    if youngest is not None:
        older = sorted(age for age in tried if age >= youngest)
        assert not failing & set(older)
        assert all(after - before <= 1.0 for before, after in pairwise(older))


def test_the_grid_has_every_half_month_of_two_years():
    assert AGES[:3] == [0.0, 0.5, 1.0]
    assert len(AGES) == 49


@given(st.integers(0, 49), st.sampled_from(AGES))
def test_from_any_age_on_the_walk_finds_what_the_search_does_of_an_infant_that_learns_once(first, near):
    outcome = walk(AGES, near, lambda age: Outcome(age >= 0.5 * first, 1.0))
    youngest, _ = searched(AGES, lambda age: age >= 0.5 * first)
    assert outcome.youngest_months == youngest
    assert len(outcome.outcomes) <= 2 + abs(2 * near - first)


@pytest.mark.full
def test_near_the_expected_age_a_child_is_found_to_rise_when_the_plain_search_finds_it_with_fewer_attempts():
    """A light, lean child that matures slowly."""
    individual = {"sex": "male", "length_percentile": 60, "weight_percentile": 20, "maturation_rate": 0.9}
    spec = InfantSpec(mimoc=1, name="kim", age_months=0, body={"individual": individual})
    near = search_near(spec, Conditions(), "pull_to_stand")
    plain = search(spec, Conditions(), ["pull_to_stand"], [age for age in AGES if age <= 10])["pull_to_stand"]
    assert near.youngest_months == plain.youngest_months
    assert len(near.outcomes) < len(plain.outcomes)


def test_every_trial_has_an_age_to_begin_at():
    assert EXPECTED_MONTHS.keys() == TRIALS.keys()
    assert set(EXPECTED_MONTHS.values()) <= set(AGES)

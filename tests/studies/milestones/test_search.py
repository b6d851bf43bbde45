"""The search for the age from which on a trial succeeds."""

from itertools import pairwise

from hypothesis import given, strategies as st

from mimoc.studies.milestones.search import AGES, search_downwards
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

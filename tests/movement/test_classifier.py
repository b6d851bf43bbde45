"""Whether two groups of infants can be told apart."""

import numpy as np
import pytest
from support.moving import restless

from mimoc.base.errors import MovementError
from mimoc.movement.classifier import Windows, told_apart, windows_of


def drawn(seed: int, mean: float = 0.0, infants: int = 12) -> Windows:
    values = np.random.default_rng(seed).normal(mean, 1, (4 * infants, 21))
    return Windows(values, np.repeat(np.arange(infants), 4))


def test_windows_are_whole_and_know_their_infant():
    windows = windows_of([restless(0, 17.0), restless(1, 33.0)])
    assert windows.values.shape == (6, 21)
    assert windows.infants.tolist() == [0, 0, 1, 1, 1, 1]


def test_groups_that_are_far_apart_are_always_told_apart():
    assert told_apart(drawn(0), drawn(1, mean=4.0)) == 1


def test_groups_of_the_same_kind_are_told_apart_by_chance():
    scores = [told_apart(drawn(seed), drawn(100 + seed)) for seed in range(10)]
    assert np.mean(scores) == pytest.approx(0.5, abs=0.1)


def test_it_does_not_matter_which_group_is_first():
    first, second = drawn(0), drawn(1, mean=0.3)
    assert told_apart(first, second) == told_apart(second, first)


def test_units_of_measures_do_not_matter():
    first, second = drawn(0), drawn(1, mean=0.3)
    scales = np.logspace(-2, 2, 21)
    scaled = (Windows(group.values * scales + 7, group.infants) for group in (first, second))
    assert told_apart(*scaled) == told_apart(first, second)


def test_an_infant_that_differs_from_its_group_does_not_teach_the_classifier_itself():
    """Infants that differ by what they alone do are not told apart, though their windows are alike."""
    generator = np.random.default_rng(0)
    groups = [
        Windows(np.repeat(generator.normal(size=(6, 21)), 4, axis=0), np.repeat(np.arange(6), 4)) for _ in range(2)
    ]
    assert told_apart(*groups) < 0.8


@pytest.mark.parametrize("groups", [(drawn(0, infants=1), drawn(1)), (drawn(0), drawn(1, infants=1))])
def test_one_infant_is_no_group(groups):
    with pytest.raises(MovementError, match="each group needs two infants or seeds, or more"):
        told_apart(*groups)


def test_a_recording_shorter_than_a_window_is_refused():
    with pytest.raises(MovementError, match=r"moving: is 5\.0 s long; to be told apart it needs at least 8 s"):
        windows_of([restless(0, 5.0)])

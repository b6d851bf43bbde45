"""Preferential looking: the card, the decision and its threshold."""

import math

import numpy as np
import pytest

from mimoc.studies.experiments.looking import NOISE, RIGHT, CardTrial, Eyes, crossing, right_choices

NARROW = {"size_px": 128, "fovy_deg": 58.0}
"""Enough for gratings of one cycle per degree at 38 cm."""


def test_without_a_difference_a_side_is_chosen_by_chance_and_a_threshold_is_a_fixed_difference():
    assert right_choices(np.array([0.1, 0.1])) == pytest.approx(0.5)
    at_threshold = 0.6745 * math.sqrt(2) * NOISE
    assert right_choices(np.array([0.0, at_threshold])) == pytest.approx(RIGHT, abs=1e-3)
    assert right_choices(np.array([0.3, 0.0])) == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("shares", "at"),
    [([0.5, 0.5, 1.0, 1.0], 2 * 2**0.5), ([0.5, 1.0, 0.6, 1.0], 4 * 2 ** (3 / 8)), ([0.8, 0.9, 1, 1], 1)],
)
def test_the_threshold_is_where_choices_become_right_for_good(shares, at):
    assert crossing([1, 2, 4, 8], shares) == pytest.approx(at)


def test_what_is_never_preferred_has_no_threshold():
    assert math.isnan(crossing([1, 2, 4], [0.5, 0.6, 0.5]))


def test_a_card_is_drawn_with_the_contrast_that_is_printed_and_grey_on_the_other_side():
    """Within 15 %, as pixels average over bars; its other side has none."""
    with CardTrial(Eyes(3, 0.38, **NARROW, keys=(("acuity", "off"),)), 0.25) as trial:
        assert trial.frequency_cpd == pytest.approx(5 / math.degrees(0.125 / 0.38))
        for contrast in (0.8, 0.2):
            seen = trial.look(contrast)
            assert seen.drawn[1] == pytest.approx(contrast, rel=0.15)
            assert seen.drawn[0] == pytest.approx(0, abs=1e-9)
            assert seen.observed == pytest.approx(seen.drawn, abs=1e-9)


def test_an_infant_prefers_coarse_bars_and_not_those_that_it_cannot_see():
    """At one month, whose acuity is .66 cycles per degree."""
    choices = []
    for frequency_cpd in (0.3, 1.0):
        with CardTrial(Eyes(1, 0.38, **NARROW), frequency_cpd) as trial:
            choices.append(right_choices(trial.look().observed))
    assert choices[0] > 0.99
    assert choices[1] < 0.7


def test_faint_bars_are_preferred_at_six_months_and_not_at_one():
    choices = []
    for age_months in (1, 6):
        with CardTrial(Eyes(age_months, 0.38, **NARROW, keys=(("contrast", "age"),)), 0.3) as trial:
            choices.append(right_choices(trial.look(0.15).observed))
    assert choices[0] < 0.6
    assert choices[1] > 0.99

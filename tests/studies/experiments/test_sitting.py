"""What the experiment on sitting changes of an infant, and what it says of what it found."""

from types import SimpleNamespace
from typing import Any

import pytest

from mimoc.studies.experiment import Results, TrialResult
from mimoc.studies.experiments.sitting import (
    NEWBORN,
    OLDER,
    OWN,
    Case,
    effect,
    policy,
    proportions_cm,
    sitting_months,
    spec_of,
)

OF_AGE = spec_of(Case(6.0))


@pytest.mark.parametrize(
    ("factor", "level", "changed"),
    [
        ("strength", OLDER, "actuation"),
        ("delays", "none", "delays"),
        ("noise of senses", NEWBORN, "noise"),
        ("noise of commands", OLDER, "noise"),
    ],
)
def test_one_factor_changes_and_all_others_stay(factor, level, changed):
    other = spec_of(Case(6.0, factor, level))
    assert [
        key for key in ("body", "actuation", "senses", "delays", "noise") if getattr(other, key) != getattr(OF_AGE, key)
    ] == [changed]
    assert other.age_months == OF_AGE.age_months


def test_senses_of_adults_are_less_noisy_than_those_of_newborns():
    noises = [spec_of(Case(6.0, "noise of senses", level)).noise for level in (NEWBORN, OLDER)]
    newborn, adult = (noise.proprioception_deg for noise in noises)
    assert newborn > OF_AGE.noise.proprioception_deg > adult > 0


def test_only_the_forward_model_is_wrong_about_the_weight():
    assert spec_of(Case(6.0, "forward model", "weight of 4 weeks ago")) == OF_AGE
    assert policy(Case(6.0, "forward model", "weight of 4 weeks ago")) == "sit(lag_weeks=4)"


def test_newborns_proportions_are_a_larger_head_on_shorter_legs():
    own, newborn = proportions_cm(6.0, 6.0), proportions_cm(6.0, 0.0)
    assert newborn["crown_sole_length_cm"] == own["crown_sole_length_cm"]
    assert newborn["head_circumference_cm"] > own["head_circumference_cm"]
    assert newborn["rump_knee_length_cm"] < own["rump_knee_length_cm"]


def results(**held_s: list[float]) -> Results:
    """Return trials of 6 and 7 months, by level of the strength; `own` is all of the own age."""
    by_case = dict[Case, list[TrialResult]]()
    for level, values in held_s.items():
        for age, value in zip((6.0, 7.0), (values, [item + 1 for item in values]), strict=True):
            case = Case(age) if level == "own" else Case(age, "strength", {"newborn": NEWBORN, "older": OLDER}[level])
            by_case[case] = [TrialResult(values={"held_s": item, "holds": float(item >= 10)}) for item in value]
    notebook: Any = SimpleNamespace(quick=False)
    return Results(notebook, range(3), by_case)


def test_infants_sit_from_the_age_at_which_half_of_them_do():
    found = results(own=[10, 9, 1], newborn=[1, 2, 3])
    assert sitting_months(found, OWN) == 7.0
    assert sitting_months(found, "strength", NEWBORN) is None


def test_an_effect_is_shown_if_pairs_agree_on_it():
    found = results(own=[5, 6, 7], newborn=[1, 2, 3], older=[6, 5, 7])
    weak, strong = (effect(found, "strength", level) for level in (NEWBORN, OLDER))
    assert (weak.harder, weak.changes_s, weak.verdict) == (True, [-4.0] * 6, "as expected")
    assert (strong.harder, strong.verdict) == (False, "not shown")

"""Motor development: strength over load, posture at rest, and searches that can be interrupted."""

from itertools import pairwise

import pytest

from mimoc.studies.experiments.development import rest
from mimoc.studies.experiments.strength import GROUPS, strengths
from mimoc.studies.milestones import search as milestone_searches
from mimoc.studies.milestones.infant import Conditions
from mimoc.studies.milestones.search import Case, forget_searches, run_searches, walk
from mimoc.studies.milestones.trial import Outcome

GRID = (0.0, 2.0, 4.0, 6.0, 8.0)
CASES = [Case("maturing", name, GRID, Conditions()) for name in ("sit", "stand")]


def ratios(development: str, ages_months=(0, 4, 9, 18)) -> dict[tuple[str, int], list[float]]:
    """Return torque by gravity moment at some ages, by motor and direction."""
    found: dict[tuple[str, int], list[float]] = {}
    for age_months in ages_months:
        for each in strengths(development, age_months):
            found.setdefault((each.actuator, each.direction), []).append(each.ratio)
    return found


def test_under_maturing_every_motor_but_those_of_fingers_gains_on_its_load_until_18_months():
    """Fingers are strongest for their load at birth, since newborns hang by their hands, and gain on it later."""
    found = ratios("maturing")
    assert set(GROUPS.values()) <= set(found)
    fingers = [found.pop((f"act:{side}_fingers", direction)) for side in ("left", "right") for direction in (-1, 1)]
    assert all(one < next_one for values in found.values() for one, next_one in pairwise(values))
    assert all(newborn > four > nine < older < newborn for newborn, four, nine, older in fingers)


def test_under_published_every_motor_loses_to_its_load_from_one_month_on():
    """In the first month, where MIMo v2's curves are steep, trunk and arms gain on theirs."""
    found = ratios("published", (1, 4, 9, 18)).values()
    assert all(one > next_one for values in found for one, next_one in pairwise(values))


def test_only_a_maturing_newborn_rests_flexed_and_drops_its_head():
    """The ranges are those of issue and literature: hips bent by 40 to 80 degrees, knees by 70 to 110."""
    maturing, published = rest("maturing", 0), rest("published", 0)
    assert -80 < maturing.hip_deg < -40
    assert -110 < maturing.knee_deg < -70
    assert published.hip_deg > -20
    assert published.knee_deg > -40
    assert maturing.head_upright_deg > 60
    assert maturing.head_back_deg < -60
    assert published.head_upright_deg < 20


def test_six_months_later_the_flexed_posture_is_gone():
    assert rest("maturing", 6).elbow_deg > -20


@pytest.mark.parametrize(("true_months", "tried"), [(4.0, [2.0, 4.0]), (2.0, [0.0, 2.0, 4.0]), (8.0, [4.0, 6.0, 8.0])])
def test_a_walk_tries_ages_from_a_given_one_until_success_turns_to_failure(true_months, tried):
    found = walk(GRID, 4.0, lambda age: Outcome(age >= true_months, 1.0))
    assert found.youngest_months == true_months
    assert list(found.outcomes) == tried


def test_a_walk_that_never_succeeds_finds_nothing():
    assert walk(GRID, 4.0, lambda age: Outcome(False, 1.0)).youngest_months is None


def test_finished_searches_outlive_an_interruption(tmp_path, monkeypatch):
    searched = []

    def search(case: Case, attempt):
        searched.append(case.trial)
        if searched == ["sit", "stand"]:
            raise KeyboardInterrupt
        return walk(case.ages, 4.0, lambda age: Outcome(age >= 6, 1.5, "falls" * (age < 6), "upright"))

    monkeypatch.setattr(milestone_searches, "_search", search)
    with pytest.raises(KeyboardInterrupt):
        run_searches(CASES, tmp_path, 1, lambda place: None)
    counted = []
    found = run_searches(CASES, tmp_path, 1, lambda place: counted.append(1))
    assert searched == ["sit", "stand", "stand"]
    assert len(counted) == len(CASES)
    assert found[CASES[0]] == found[CASES[1]]
    forget_searches(tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_damaged_search_is_done_again(tmp_path, monkeypatch):
    monkeypatch.setattr(
        milestone_searches, "_search", lambda case, _: walk(GRID, 4.0, lambda age: Outcome(age >= 2, 1.0))
    )
    first = run_searches([CASES[0]], tmp_path, 1, lambda place: None)
    (file,) = tmp_path.rglob("*.json")
    for content in ("{", '{"youngest_months": "two", "tried": []}', '{"youngest_months": 1e999, "tried": []}'):
        file.write_text(content)
        assert run_searches([CASES[0]], tmp_path, 1, lambda place: None) == first


def test_searches_under_other_conditions_are_kept_apart(tmp_path, monkeypatch):
    slower = Case("maturing", "sit", GRID, Conditions(servo=0.8), near_months=4.0)
    monkeypatch.setattr(
        milestone_searches,
        "_search",
        lambda case, _: walk(GRID, 4.0, lambda age: Outcome(age >= (6 if case.near_months else 2), 1.0)),
    )
    run_searches([CASES[0]], tmp_path, 1, lambda place: None)
    found = run_searches([CASES[0], slower], tmp_path, 1, lambda place: None)
    assert [found[case].youngest_months for case in (CASES[0], slower)] == [2.0, 6.0]

"""When the children of a cohort reach milestones."""

from pathlib import Path
from statistics import NormalDist

import pytest

from mimoc.base.errors import MimocError, SpecError
from mimoc.base.quantities import measured_in
from mimoc.base.quantities.milestones import MILESTONE_AGES
from mimoc.studies.cohorts.cohort import read_cohort
from mimoc.studies.cohorts.milestones import ALL, WHO, milestone_summary
from mimoc.studies.milestones.trials import TRIALS

EXAMPLE = Path(__file__).parents[3] / "examples/cohort/milestones.yaml"


def row(sit, stand=10.0, *, weight=50.0, fat=50.0, status="ok"):
    """Return a row of the table of a cohort."""
    percentiles = {"length_percentile": 50.0, "weight_percentile": weight, "fat_percentile": fat}
    return {"step": "milestones", "status": status, "sit_months": sit, "stand_months": stand, **percentiles}


def test_the_example_has_200_children_who_differ_in_more_than_size():
    jobs = read_cohort(EXAMPLE).jobs()
    assert len({job.factors["maturation_rate"] for job in jobs}) == len(jobs) == 200
    assert jobs[0].options["trials"] == [*WHO]


def test_each_trial_has_its_quantity():
    assert MILESTONE_AGES.keys() == TRIALS.keys()
    assert {quantity.name for quantity in MILESTONE_AGES.values()} <= {item.name for item in measured_in("milestones")}


def test_ages_are_summed_up_beside_whos():
    rows = [row(5.0), row(6.0), row(8.5), row(None), row(1.0, status="failed"), {"step": "build", "status": "ok"}]
    sit, stand = milestone_summary(rows).spreads
    assert (sit.n, sit.not_reached, sit.mean_months) == (3, 1, 6.5)
    assert sit.sd_months == pytest.approx((1.5**2 / 2 + 0.5**2 / 2 + 2.0**2 / 2) ** 0.5)
    assert (sit.who_mean_months, sit.who_sd_months) == (6.0, 1.1)
    assert (stand.sd_months, stand.who) == (0.0, "standing alone")


def test_the_odds_of_being_late_are_those_of_the_counted_children():
    """Of ten fat children four are late, of forty others four: (4.5 x 36.5) / (6.5 x 4.5)."""
    rows = [row(9.0 if index % 10 < 4 else 5.0, fat=95.0) for index in range(10)]
    rows += [row(9.0 if index % 10 < 1 else 5.0) for index in range(40)]
    odds = {(item.group, item.trial): item for item in milestone_summary(rows).odds}
    assert {group for group, _ in odds} == {"fat"}  # None is heavy.
    sit = odds["fat", "sit"]
    assert (sit.n, sit.late, sit.others, sit.late_others) == (10, 4, 40, 4)
    assert sit.odds_ratio == pytest.approx(36.5 / 6.5)
    assert sit.low < 1.3 < sit.odds_ratio < sit.high
    assert odds["fat", ALL].late == 4
    assert odds["fat", "stand"].late == 0


def test_a_child_is_heavy_for_its_length_in_the_uppermost_tenth():
    """Of the length of half of all children, where the weight has .67 of its spread."""
    limit = 100 * NormalDist().cdf(NormalDist().inv_cdf(0.9) * (1 - 0.74**2) ** 0.5)
    rows = [row(6.0, weight=limit + 0.1), row(5.0, weight=limit - 0.1), row(7.0)]
    assert {item.n for item in milestone_summary(rows).odds if item.group == "heavy for length"} == {1}


def test_children_that_never_succeed_are_late():
    rows = [row(5.0), row(5.5), row(6.0), row(None, fat=95.0)]
    (sit,) = [item for item in milestone_summary(rows).odds if item.trial == "sit"]
    assert (sit.n, sit.late) == (1, 1)


def test_a_cohort_without_milestones_says_what_to_write():
    with pytest.raises(MimocError, match=r"write 'do: \[milestones\]', and run it"):
        milestone_summary([{"step": "build", "status": "ok"}])


@pytest.mark.parametrize(
    ("step", "message"),
    [
        ({"milestones": {"trials": ["sitting"]}}, "'sitting' is not a trial of milestones"),
        ({"milestones": {"trials": []}}, "name one or more, or remove the key"),
        ({"milestones": {"trials": ["sit", "sit"]}}, "'sit' more than once"),
    ],
)
def test_unknown_trials_are_refused(cohort, step, message):
    with pytest.raises(SpecError, match=message):
        cohort(do=[step])


def test_the_step_finds_that_the_slower_of_two_children_is_later(cohort, here, tmp_path):
    keys = {"children": {"draw": 2, "seed": 1}, "do": [{"milestones": {"trials": ["pull_to_stand"]}}]}
    study, out = cohort(**keys), tmp_path / "out"
    assert study.run(out, here).number("ok") == 2
    rows = study.rows(out)
    assert all(5 <= item["pull_to_stand_months"] <= 12 and item["mass_kg"] > 4 for item in rows)
    assert rows[0]["maturation_rate"] < rows[1]["maturation_rate"]
    assert rows[0]["pull_to_stand_months"] > rows[1]["pull_to_stand_months"]

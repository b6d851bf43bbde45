"""What a report on milestones says."""

import pytest

import mimoc
from mimoc.cli.tables import print_milestones
from mimoc.render.plots.file import draw
from mimoc.studies.cohorts.milestones import WHO
from mimoc.studies.growth.plot import rows_sheet
from mimoc.studies.milestones import (
    TRIALS,
    WINDOWS,
    Conditions,
    Milestone,
    MilestoneReport,
    Outcome,
    validate_milestones,
)
from mimoc.studies.milestones.report import is_average
from mimoc.studies.milestones.search import SearchResult


def report(*ages_months):
    """Return a report on sitting, whose window is 3.8 to 9.2 months, and pulling to stand, which is not judged."""
    found = [SearchResult(age, {0.0: Outcome(age == 0.0, 1.0)}) for age in ages_months]
    names = ("sit", "pull_to_stand")
    milestones = [
        Milestone(TRIALS[name], {"": one}, WINDOWS[name], name == "sit") for name, one in zip(names, found, strict=True)
    ]
    return MilestoneReport("maturing", "torque", Conditions(), milestones)


@pytest.mark.parametrize(
    ("age_months", "verdict"),
    [(3.5, "too early"), (3.8, "inside"), (9.2, "inside"), (9.5, "too late"), (None, "not reached")],
)
def test_an_age_is_judged_by_the_window_of_real_infants(age_months, verdict):
    judged = report(age_months, 0.0)
    assert [each.verdict for each in judged.milestones] == [verdict, "no verdict"]
    assert judged.passed == (verdict == "inside")


@pytest.mark.parametrize(
    ("name", "age_months", "verdict"),
    [
        ("stand", 8.5, "too early"),
        ("stand", 9.1, "inside"),
        ("stand", 12.9, "inside"),
        ("stand", 13.0, "too late"),
        ("hands_and_knees", 6.0, "too early"),
        ("sit", 4.9, "inside"),
        ("sit", 7.5, "too late"),
        ("arm_out", 5.0, "inside"),
        ("arm_out", 5.5, "too late"),
    ],
)
def test_the_average_child_is_judged_by_mean_and_sd_where_these_are_known(name, age_months, verdict):
    assert WINDOWS[name].verdict(age_months, of_average=True) == verdict
    milestone = Milestone(TRIALS[name], {"": SearchResult(age_months)}, WINDOWS[name], True, of_average=True)
    assert (milestone.verdict, milestone.failed) == (verdict, verdict != "inside")


def test_only_a_child_of_which_the_spec_says_nothing_is_average():
    child = mimoc.InfantSpec(mimoc=1, name="kim", age_months=9)
    assert is_average(child)
    assert is_average(child.with_(actuation={"model": "muscle"}, development="published"))
    for own in (
        {"body": {"individual": {"sex": "female", "length_percentile": 3}}},
        {"body": {"remove": ["left_hand"]}},
        {"impairments": {"gestation_weeks": 30}},
        {"actuation": {"strength": {"arms": 0.5}}},
    ):
        assert not is_average(child.with_(**own))


def test_the_table_of_the_average_child_has_mean_and_sd(capsys):
    milestone = Milestone(TRIALS["stand"], {"": SearchResult(8.5)}, WINDOWS["stand"], True, of_average=True)
    print_milestones(MilestoneReport("maturing", "torque", Conditions(), [milestone]))
    printed = " ".join(capsys.readouterr().out.split())
    assert "9.1-12.9" in printed
    assert "mean ± 1 SD" in printed
    assert "failed: outside the window of real infants: stand" in printed
    assert milestone.to_data()["judged_by_months"] == (9.1, 12.9)


def test_the_table_names_what_is_outside_and_the_sources(capsys):
    print_milestones(report(2.0, None))
    printed = capsys.readouterr().out
    assert "failed: outside the window of real infants: sit" in printed
    assert "never" in printed
    assert "WHO" in printed
    table = [line for line in printed.splitlines() if line.startswith(tuple("┏┃┡│└"))]
    assert len(table) == 6
    assert max(map(len, table)) <= 80
    assert all(cell.strip() for cell in table[1].split("┃")[1:-1])


def test_the_plot_has_a_bar_for_each_milestone():
    (axes,) = draw(rows_sheet(report(6.0, None).rows, "real infants")).axes
    assert len(axes.collections) == 2
    assert [label.get_text() for label in axes.get_yticklabels()] == [TRIALS[n].title for n in ("sit", "pull_to_stand")]


def test_the_data_has_every_attempt():
    found = validate_milestones(names=["leg_lift"], ages=[0, 24]).to_data()
    (milestone,) = found["milestones"]
    assert [each["age_months"] for each in milestone["tried"]] == [0, 24]
    assert milestone["verdict"] == "no verdict"


@pytest.mark.parametrize("name", ["pull_to_stand", "supine_head"])
def test_a_newborn_does_not_get_up_nor_lift_its_head_from_its_back(name):
    found = validate_milestones(names=[name], ages=[0, 12]).milestones[0].result
    assert found.youngest_months == 12
    assert not found.at_birth


def test_cohorts_are_compared_with_the_means_of_the_windows():
    """The summary of a cohort has WHO's standard deviations besides; it may not import studies."""
    for trial, (_, mean_months, sd_months) in WHO.items():
        window = WINDOWS.get(trial)
        assert window is None or (window.usual_months, window.sd_months) == (mean_months, sd_months), trial

"""What a report on milestones says."""

from dataclasses import replace

import pytest

import mimoc
from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.cli.tables import print_milestones
from mimoc.fits import load_tables
from mimoc.fits.standards import percentile
from mimoc.render.plots import draw
from mimoc.schema.body import INDICATORS
from mimoc.schema.counterparts import counterpart, exchanged, has_like_sides
from mimoc.schema.infant import InfantSpec
from mimoc.studies import milestones as milestone_reports
from mimoc.studies.growth_plots import rows_sheet
from mimoc.studies.milestones import WINDOWS, Milestone, MilestoneReport, is_average, validate_milestones
from mimoc.studies.milestones.search import SearchResult
from mimoc.studies.milestones.trial import USUAL, Conditions, Outcome, compile_at, try_out
from mimoc.studies.milestones.trials import TRIALS


def report(*ages_months):
    """Return a report on sitting, whose window is 3.8 to 9.2 months, and pulling to stand, which is not judged."""
    found = [SearchResult(youngest_months=age, outcomes={0.0: Outcome(age == 0.0, 1.0)}) for age in ages_months]
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
    milestone = Milestone(
        TRIALS[name], {"": SearchResult(youngest_months=age_months)}, WINDOWS[name], True, of_average=True
    )
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
    milestone = Milestone(
        TRIALS["stand"], {"": SearchResult(youngest_months=8.5)}, WINDOWS["stand"], True, of_average=True
    )
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


@pytest.mark.parametrize(
    ("conditions", "said"),
    [
        (USUAL, "with delays and noise of senses and commands; an attempt counts if at least half of 3 seeds succeed"),
        (Conditions(delays=True), "with delays of senses and commands, without noise"),
        (Conditions(noise=True, seeds=5), "with noise of senses and commands; an attempt counts if at least half of 5"),
        (Conditions(), "the body alone, without delays and noise"),
    ],
)
def test_the_table_says_what_of_the_nervous_system_was_tried(capsys, conditions, said):
    print_milestones(replace(report(6.0, None), conditions=conditions))
    assert said in " ".join(capsys.readouterr().out.split())


def test_by_default_infants_are_compared_with_a_nervous_system(monkeypatch):
    asked = []

    def search(spec, conditions, names, *_):
        asked.append(conditions)
        return {name: SearchResult(youngest_months=4.0, outcomes={4.0: Outcome(True, 6.0)}) for name in names}

    monkeypatch.setattr(milestone_reports, "search_trials", search)
    assert validate_milestones(names=["sit"]).conditions == USUAL
    assert asked == [Conditions(delays=True, noise=True)]


def test_the_data_has_every_attempt():
    found = validate_milestones(None, Conditions(), names=["leg_lift"], ages=[0, 24]).to_data()
    (milestone,) = found["milestones"]
    assert [each["age_months"] for each in milestone["tried"]] == [0, 24]
    assert milestone["verdict"] == "no verdict"


@pytest.mark.parametrize("name", ["pull_to_stand", "supine_head"])
def test_a_newborn_does_not_get_up_nor_lift_its_head_from_its_back(name):
    found = validate_milestones(None, Conditions(), names=[name], ages=[0, 12]).milestones[0].result
    assert found.youngest_months == 12
    assert not found.at_birth


CHILD = InfantSpec(mimoc=1, name="child", age_months=6)
WEAK = CHILD.with_(impairments={"weakness": {"right_arm": 0.05}})


def arms_out(spec, **options):
    report = validate_milestones(spec, Conditions(), names=["arm_out"], ages=[0, 5], **options)
    (milestone,) = report.milestones
    return milestone, report


@pytest.mark.parametrize(
    "weak",
    [WEAK, CHILD.with_(actuation={"strength": {"right_arm": 0.05, "right_hand": 0.05}})],
    ids=["arm", "strength"],
)
def test_a_weak_right_arm_never_reaches_out_and_the_left_one_does_as_the_healthy_childs(weak):
    milestone, report = arms_out(weak, beside="healthy")
    (healthy,) = report.beside["healthy"].milestones
    assert {side: result.youngest_months for side, result in milestone.sides.items()} == {"left": 5, "right": None}
    assert {side: result.youngest_months for side, result in healthy.sides.items()} == {"left": 5, "right": 5}
    assert (milestone.verdict, milestone.side, healthy.side) == ("not reached", "right", "")
    assert not report.passed
    data = report.to_data()["milestones"][0]
    assert [data["sides"][side]["verdict"] for side in ("left", "right")] == ["inside", "not reached"]
    assert (data["worse_side"], data["verdict"], data["basis"]) == ("right", "not reached", "predicted")


@pytest.mark.parametrize(("name", "ages"), [("arm_out", (3.0, 5.0)), ("leg_lift", (3.0, 5.0))])
def test_sides_that_are_alike_do_alike_so_that_one_of_them_tells_of_both(name, ages):
    for age_months in ages:
        infant = compile_at(CHILD, age_months, Conditions())
        left, right = (try_out(TRIALS[name], infant, Conditions(), side) for side in ("left", "right"))
        assert left.success == right.success == (age_months == 5.0)
        assert left.seconds == pytest.approx(right.seconds, abs=0.3)


def test_only_who_differs_between_its_sides_tries_with_both(monkeypatch):
    asked = []

    def search(spec, conditions, names, *_):
        asked.append(names)
        return {
            name: SearchResult(youngest_months=4.0, outcomes={4.0: Outcome(True, 6.0, "", "right arm")})
            for name in names
        }

    monkeypatch.setattr(milestone_reports, "search_trials", search)
    milestone, _ = arms_out(CHILD)
    arms_out(WEAK)
    assert asked == [["arm_out:right"], ["arm_out:left", "arm_out:right"]]
    assert milestone.sides["left"].outcomes[4.0].strategy == "left arm"


def test_a_spec_says_the_same_of_both_sides_whatever_it_is_called():
    assert has_like_sides(CHILD.with_(name="right_handed"))
    assert has_like_sides(CHILD.with_(body={"remove": ["left_hand", "right_hand"]}))
    assert not has_like_sides(CHILD.with_(body={"remove": ["left_hand"]}))
    assert exchanged("copyright of left_hand, right") == "copyright of right_hand, left"


def test_the_counterpart_has_to_be_known_and_another_child():
    with pytest.raises(UnknownNameError, match="'helthy' is not a child to stand beside; did you mean 'healthy'"):
        counterpart(WEAK, "helthy")
    with pytest.raises(MimocError, match="child: nothing impairs this child"):
        counterpart(CHILD, "healthy")


def found(**ages_months):
    return {
        side: SearchResult(youngest_months=age, outcomes={0.0: Outcome(False, 1.0)})
        for side, age in ages_months.items()
    }


@pytest.mark.parametrize(
    ("left", "right", "verdict", "side"),
    [
        (4.0, 4.0, "inside", ""),
        (4.0, 4.5, "inside", "right"),
        (5.5, 4.0, "too late", "left"),
        (2.0, 4.0, "too early", "left"),
        (4.0, None, "not reached", "right"),
    ],
)
def test_a_milestone_is_judged_by_its_worse_side(left, right, verdict, side):
    milestone = Milestone(TRIALS["arm_out"], found(left=left, right=right), WINDOWS["arm_out"], True)
    assert (milestone.verdict, milestone.side) == (verdict, side)
    assert milestone.failed == (verdict != "inside")


def table(capsys, *milestones, **beside):
    print_milestones(MilestoneReport("maturing", "torque", Conditions(), milestones, beside))
    return [line for line in capsys.readouterr().out.splitlines() if line.startswith("│")]


def test_the_table_shows_sides_that_differ_and_the_healthy_child(capsys):
    sit = Milestone(TRIALS["sit"], {"": SearchResult(youngest_months=6.0)}, WINDOWS["sit"], True)
    arms = Milestone(TRIALS["arm_out"], found(left=4.0, right=None), WINDOWS["arm_out"], True)
    alike = Milestone(TRIALS["arm_out"], found(left=4.0, right=4.0), WINDOWS["arm_out"], True)
    healthy = MilestoneReport("maturing", "torque", Conditions(), [sit, alike])
    assert [line.split("│")[1:3] for line in table(capsys, sit, alike)] == [
        ["sit      ", "            6"],
        ["arm_out  ", "            4"],
    ]
    assert [[cell.strip() for cell in line.split("│")[1:-1]] for line in table(capsys, sit, arms, healthy=healthy)] == [
        ["sit", "6", "6", "3.8-9.2", "6", "inside", "fitted"],
        ["arm_out, left", "4", "4", "3.5-5", "", "inside", "predicted"],
        ["arm_out, right", "never", "4", "3.5-5", "", "not reached", "predicted"],
    ]


def test_the_same_child_by_cm_and_by_percentiles_has_the_same_table(capsys):
    by_cm = {"sex": "male", "length_cm": 66.0, "weight_kg": 7.2, "head_circumference_cm": 43.1}
    who = load_tables().who
    percentiles = {INDICATORS[key]: percentile(who[key].z_score(by_cm[key], 6, "male")) for key in INDICATORS}
    children = [WEAK.with_(body={"individual": one}) for one in (by_cm, {"sex": "male", **percentiles})]
    printed = []
    for child in children:
        _, report = arms_out(child)
        print_milestones(report)
        printed.append(capsys.readouterr().out)
    assert printed[0] == printed[1]
    assert "arm_out, right" in printed[0]


def test_the_ages_that_the_law_was_fitted_to_are_called_so():
    assert {name for name, trial in TRIALS.items() if trial.basis == "fitted"} == {"prone_head", "sit", "stand"}


def test_nobody_is_judged_by_an_assumption_and_no_window_rests_on_memory():
    assumed = WINDOWS["sit"].model_copy(update={"certainty": "assumption"})
    assert {assumed.verdict(age) for age in (None, 0.0, 6.0, 20.0)} == {"no verdict"}
    assert {window.certainty for window in WINDOWS.values()} == {"read", "read in another source"}
    assert all(any(mark in window.source for mark in ("19", "20")) for window in WINDOWS.values())


@pytest.mark.full
def test_a_child_born_early_is_tried_from_term_on_and_judged_by_its_corrected_age():
    """Its head lags until four months after term, 6.3 months after it was born."""
    preterm = mimoc.InfantSpec(mimoc=1, name="early", age_months=9, impairments={"gestation_weeks": 30})
    (milestone,) = mimoc.validate_milestones(preterm, Conditions(), names=["no_head_lag"]).milestones
    tried = sorted(milestone.result.outcomes)
    assert tried[0] == 2.5
    assert milestone.result.youngest_months == pytest.approx(4 + milestone.months_early, abs=0.5)
    assert milestone.verdict == "inside"

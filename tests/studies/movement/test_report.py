"""What a report on movement says, and of what."""

from dataclasses import replace

import pytest

import mimoc
from mimoc.base.errors import UnknownNameError
from mimoc.cli.tables import print_movement
from mimoc.render.plots import draw, windows_sheet
from mimoc.schema.infant import InfantSpec
from mimoc.studies.movement import TRIALS, WINDOWS, MovementReport, Row, window_of

MEASURES = {measure.name: measure for trial in TRIALS.values() for measure in trial.measures}
CHILD = InfantSpec(mimoc=1, name="child", age_months=0)


def row(measure, age_months, value, reason=""):
    (trial,) = (trial for trial in TRIALS.values() if MEASURES[measure] in trial.measures)
    return Row(trial.name, MEASURES[measure], age_months, value, window_of(measure, age_months), reason)


@pytest.mark.parametrize(
    ("measure", "age_months", "value", "verdict"),
    [
        ("fold_leg", 3.0, 0.45, "inside"),
        ("fold_leg", 3.0, 0.46, "outside"),
        ("kick_deg", 3.0, 20.0, "no verdict"),
        ("kick_deg", 9.0, 20.0, "no verdict"),
        ("kick_s", 3.0, None, "not reached"),
        ("shank_swings", 0.0, 9.0, "outside"),
        ("kick_share", 3.0, 1.0, "no verdict"),
        ("arm_lift", 0.0, 0.9, "inside"),
    ],
)
def test_a_value_is_judged_by_the_window_of_its_age_unless_that_is_an_assumption(measure, age_months, value, verdict):
    judged = row(measure, age_months, value)
    assert judged.verdict == verdict
    assert MovementReport("maturing", "torque", [judged]).passed == (verdict in ("inside", "no verdict"))


@pytest.mark.parametrize(
    ("measure", "age_months", "value", "error"),
    [
        ("shank_swings", 3.0, 5.0, 0.0),
        ("shank_swings", 3.0, 1.0, -2.0),
        ("speed_hand", 3.0, 4.65, 0.5),
        ("kick_deg", 3.0, 40.0, None),
        ("kick_s", 3.0, None, None),
    ],
)
def test_a_value_outside_is_off_by_what_it_is_beyond_its_window(measure, age_months, value, error):
    assert row(measure, age_months, value).error == error


def test_what_is_counted_as_held_out_was_predicted_alone_and_is_a_fact_that_was_read_and_has_a_direction():
    """Not of what numbers were chosen for, two-sided windows, what was derived or recorded, nor assumptions."""
    rows = [
        row("shank_swings", 3.0, 1.0),
        row("speed_hand", 0.0, 9.0),
        row("roll_deg", 6.0, 70.0),
        row("leg_weight_less", 1.5, 0.9),
        row("posture_upright_change", 3.0, 0.45),
        row("reach_s", 4.0, 12.0),
    ]
    report = MovementReport("maturing", "torque", rows)
    assert report.held_out == rows[3:5]
    assert report.to_data()["held_out"] == {"inside": 1, "tried": 2}
    measures = {measure.name for trial in TRIALS.values() if trial.held_out for measure in trial.measures}
    assert {window.used for name, window in WINDOWS if name in measures} == {"predicted"}


def test_what_is_not_tried_does_not_fail():
    untried = row("kick_deg", 3.0, None, "this infant has no left_foot")
    assert untried.verdict == "not tried"
    assert MovementReport("maturing", "torque", [untried]).passed


def test_an_infant_without_the_limb_is_not_tried_and_the_reason_is_named():
    legless = CHILD.with_(body={"remove": ["left_lower_leg"]})
    rows = mimoc.validate_movement(legless, names=["kick", "rest"], ages=[1]).rows
    assert {one.verdict for one in rows if one.side == "left"} == {"not tried"}
    assert "not tried" not in {one.verdict for one in rows if (one.trial, one.side) == ("kick", "right")}
    assert rows[0].reason == "this infant has no left_lower_leg and no left_foot"


def test_the_limb_of_a_side_that_differs_is_measured_on_its_side():
    weak = CHILD.with_(impairments={"weakness": {"right_arm": 0.05}})
    report = mimoc.validate_movement(weak, names=["arm_lift"], ages=[3], beside="healthy")
    values = {one.name: one.value for one in report.rows}
    (healthy,) = report.beside["healthy"].rows
    assert values["arm_lift, left"] == pytest.approx(healthy.value, abs=0.02)
    assert values["arm_lift, right"] < 0.3
    assert healthy.side == "both"


@pytest.mark.parametrize(
    ("hands", "removed", "untried"),
    [
        ("mitten", "left_fingers", {"grip"}),
        ("mitten", "left_lower_arm", {"damping", "grip", "recoil"}),
        ("mitten", "right_upper_leg", {"damping", "pendulum", "stepping"}),
        ("five_finger", "left_mfknuckle", {"grip"}),
        ("five_finger", "left_thbase", set()),
    ],
)
def test_only_the_trials_that_need_a_part_are_not_tried_without_it(hands, removed, untried, monkeypatch):
    names = ["pendulum", "damping", "recoil", "grip", "stepping"]
    for name in names:
        measured = dict.fromkeys((measure.name for measure in TRIALS[name].measures), 1.0)
        monkeypatch.setitem(TRIALS, name, replace(TRIALS[name], measure=lambda subject, values=measured: values))
    spec = CHILD.with_(body={"hands": hands, "remove": [removed]})
    rows = mimoc.validate_movement(spec, names=names, ages=[1]).rows
    assert {one.trial for one in rows if one.verdict == "not tried"} == untried


def test_every_window_is_of_a_measure_and_has_an_end_and_every_trial_has_one_and_measures_of_its_own():
    assert {name for name, _ in WINDOWS} <= MEASURES.keys()
    assert len(MEASURES) == sum(len(trial.measures) for trial in TRIALS.values())
    for trial in TRIALS.values():
        assert any(window_of(measure.name, age) for measure in trial.measures for age in trial.ages_months)
    for _, window in WINDOWS:
        assert window.low is not None or window.high is not None
        assert window.low is None or window.high is None or window.low < window.high
        assert window.youngest_months <= window.oldest_months
        assert window.source


def test_the_first_window_of_an_age_is_the_one_that_counts():
    assert window_of("arm_lift", 0.0).used == "fitted"
    assert window_of("arm_lift", 1.0).used == "predicted"
    assert window_of("arm_lift", 9.0) is None


def test_an_unknown_trial_is_named():
    with pytest.raises(UnknownNameError, match="did you mean 'kick'"):
        mimoc.validate_movement(names=["kik"])


def test_a_report_is_the_same_each_time_and_has_every_measure_of_every_age():
    names, ages = ["rest", "saccade", "damping"], [0, 4]
    one, other = (mimoc.validate_movement(names=names, ages=ages).to_data() for _ in range(2))
    assert one == other
    assert len(one["rows"]) == len(ages) * sum(len(TRIALS[name].measures) for name in names)
    assert list(one["trials"]) == names


def test_progress_counts_trials_and_ages():
    steps = []
    mimoc.validate_movement(names=["damping"], ages=[0, 4], progress=lambda done, total: steps.append((done, total)))
    assert steps == [(1, 2), (2, 2)]


def test_girls_and_boys_of_other_sizes_and_hands_can_be_tried():
    spec = CHILD.with_(body={"individual": {"sex": "female", "length_percentile": 97}, "hands": "five_finger"})
    report = mimoc.validate_movement(spec, names=["rest", "arm_lift"], ages=[1])
    assert all(one.value is not None for one in report.rows)


REPORT = MovementReport(
    "maturing",
    "torque",
    [
        row("shank_swings", 0.0, 1.5),
        row("shank_swings", 3.0, 5.0),
        row("kick_s", 0.0, None),
        row("kick_share", 0.0, 0.9),
        row("grip_out_n", 0.0, None, "this infant has no left_hand"),
        row("speed_hand", 3.0, 4.65),
        row("posture_upright_change", 3.0, 0.48),
    ],
)


def test_the_table_names_what_is_outside_the_sources_and_what_was_not_tried(capsys):
    print_movement(REPORT)
    printed = capsys.readouterr().out
    assert (
        "failed: outside the window of real infants: shank_swings, kick_s, speed_hand, posture_upright_change"
        in " ".join(printed.split())
    )
    assert "grip was not tried: this infant has no left_hand" in printed
    assert "1.5*" in printed
    assert "(0.9)" in printed
    assert "Trujillo-Priego & Smith 2017" in printed
    assert "held out, facts that were read and have a direction: 0 of 1 inside" in " ".join(printed.split())
    assert "+0.5" in printed
    assert "(read; predicted)" in " ".join(printed.split())


def test_the_plot_has_a_panel_for_each_measure():
    figure = draw(windows_sheet(REPORT.panels, "real infants"))
    titles = [axes.get_title(loc="left") or axes.get_title() for axes in figure.axes if axes.get_visible()]
    assert [title for title in titles if title] == [rows[0].measure.title for rows in REPORT.by_measure.values()]

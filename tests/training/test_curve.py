import dataclasses
import math

import numpy as np
import pytest

from mimoc.base.errors import TrainingError
from mimoc.runtime.quantities import EpisodeResult
from mimoc.training import Curve, CurvePoint
from mimoc.training.curve import summarize

EPISODES = [
    EpisodeResult(90.5, 100, True, 1.0),
    EpisodeResult(-30.25, 1000, False, 10.0),
    EpisodeResult(95.0, 50, True, 0.5),
]


def test_a_row_is_about_the_episodes_that_ended():
    row = summarize(EPISODES, steps=4096, wall_s=1.5)
    assert row == CurvePoint(
        4096, 3, pytest.approx(155.25 / 3), pytest.approx(2 / 3), pytest.approx(1150 / 3), 0.75, 1.5
    )


def test_the_statistics_of_no_episodes_are_nan():
    row = summarize([], steps=10, wall_s=0.0)
    assert (row.episodes, row.steps) == (0, 10)
    assert all(math.isnan(value) for value in dataclasses.astuple(row)[2:6])


def test_a_curve_is_the_same_after_a_round_trip_through_csv():
    curve = Curve(tuple(summarize(EPISODES[:count], 10 * count, math.pi) for count in range(4)))
    again = Curve.from_csv(curve.to_csv())
    assert again.to_csv() == curve.to_csv()
    for name, column in curve.columns().items():
        np.testing.assert_array_equal(column, again.column(name))
    assert curve.to_csv().splitlines()[1] == "0,0,,,,,3.141592653589793,0,,"
    assert again.steps == 30


def test_a_row_says_what_unfinished_episodes_have_earned_so_far():
    row = summarize([], 10, 0.0, [EpisodeResult(2.0, 3, False, 0.03), EpisodeResult(-1.0, 7, False, 0.07)])
    assert (row.episodes, row.unfinished, row.unfinished_return, row.unfinished_steps) == (0, 2, 0.5, 5.0)
    assert Curve.from_csv(Curve((row,)).to_csv()).rows[0].unfinished_return == 0.5


def test_the_ends_of_a_curve_are_rows_with_episodes_that_ended_if_there_are_any():
    empty, full = (summarize(episodes, 10, 0.0) for episodes in ([], EPISODES))
    assert Curve((empty, full, empty)).ends == (full, full)
    assert Curve((empty,)).ends == (empty, empty)


def test_the_curve_of_an_earlier_version_knows_of_no_unfinished_episodes():
    text = "steps,episodes,episode_return,success_rate,episode_steps,time_to_success_s,wall_s\n8,1,2.0,0.0,4.0,,1.5\n"
    (row,) = Curve.from_csv(text).rows
    assert (row.steps, row.episode_return, row.unfinished) == (8, 2.0, 0)
    assert math.isnan(row.unfinished_return)


@pytest.mark.parametrize("text", ["a,b\n1,2\n", "steps,episodes\nmany,3\n"])
def test_a_text_that_is_not_a_curve_is_refused(text):
    with pytest.raises(TrainingError, match=r"not a learning curve; give the curve\.csv of a training run"):
        Curve.from_csv(text)


def test_an_empty_curve_has_no_steps():
    assert (Curve().steps, Curve().column("steps").shape) == (0, (0,))

import dataclasses
import math

import numpy as np
import pytest

from mimoc.errors import TrainingError
from mimoc.training import Curve, Row
from mimoc.training.curve import FinishedEpisode, summarize

EPISODES = [FinishedEpisode(90.5, 100, True), FinishedEpisode(-30.25, 1000, False), FinishedEpisode(95.0, 50, True)]


def test_a_row_is_about_the_episodes_that_ended():
    row = summarize(EPISODES, steps=4096, step_s=0.01, wall_s=1.5)
    assert row == Row(4096, 3, pytest.approx(155.25 / 3), pytest.approx(2 / 3), pytest.approx(1150 / 3), 0.75, 1.5)


def test_the_statistics_of_no_episodes_are_nan():
    row = summarize([], steps=10, step_s=0.01, wall_s=0.0)
    assert (row.episodes, row.steps) == (0, 10)
    assert all(math.isnan(value) for value in dataclasses.astuple(row)[2:6])


def test_a_curve_is_the_same_after_a_round_trip_through_csv():
    curve = Curve(tuple(summarize(EPISODES[:count], 10 * count, 1 / 3, math.pi) for count in range(4)))
    again = Curve.from_csv(curve.to_csv())
    assert again.to_csv() == curve.to_csv()
    for name, column in curve.columns().items():
        np.testing.assert_array_equal(column, again.column(name))
    assert curve.to_csv().splitlines()[1] == "0,0,,,,,3.141592653589793"
    assert again.steps == 30


@pytest.mark.parametrize("text", ["a,b\n1,2\n", "steps,episodes\nmany,3\n"])
def test_a_text_that_is_not_a_curve_is_refused(text):
    with pytest.raises(TrainingError, match=r"not a learning curve; give the curve\.csv of a training run"):
        Curve.from_csv(text)


def test_an_empty_curve_has_no_steps():
    assert (Curve().steps, Curve().column("steps").shape) == (0, (0,))

"""The paper's figures beside those measured."""

from types import SimpleNamespace
from typing import Any

import pytest

from mimoc.studies.comparison import Figure
from mimoc.studies.experiment import figure_rows, figures_of, find_experiment
from mimoc.studies.experiments import EXPERIMENTS, delays

PAPERS = ("growth", "strength", "acuity", "delays", "inverse", "rooms")


def row(paper: str, measured) -> tuple[str, ...]:
    return Figure("length [cm]", paper, "S", "its code").row(measured)[1:4]


def test_a_number_has_a_digit_more_than_the_papers_and_its_difference():
    assert row("82.6", 82.6125) == ("82.6", "82.61", "+0.01")
    assert row("+0.3", 0.296) == ("+0.3", "+0.30", "+0.00")
    assert row("10", 3) == ("10", "3", "-7")


def test_a_word_differs_or_does_not():
    assert row("yes", "yes") == ("yes", "yes", "")
    assert row("yes", "no") == ("yes", "no", "differs")
    assert row("2.25", None) == ("2.25", "never", "differs")


@pytest.mark.parametrize("name", PAPERS)
def test_each_experiment_of_the_paper_has_figures_that_say_how_they_are_known(name):
    figures = figures_of(name)
    assert len({figure.quantity for figure in figures}) == len(figures) > 0
    assert all(figure.certainty in "SDM" and figure.source for figure in figures)
    assert not list(figure_rows(name, {}))


@pytest.mark.parametrize(
    ("longer", "verdict"),
    [
        ({"units": 2.0, "path_ratio": 2.0, "arc_length": -2.0, "jerk": -7.0}, "yes"),
        ({"units": 1.0, "path_ratio": 2.0, "arc_length": -1.0, "jerk": -7.0}, "by path length and jerk only"),
        ({"units": 1.0, "path_ratio": 1.0, "arc_length": -1.0, "jerk": -6.0}, "no"),
    ],
)
def test_movements_are_less_smooth_where_every_measure_that_the_page_lists_says_so(longer, verdict):
    """The verdict beside the paper's is made from the page's list."""

    def learner(**measures) -> Any:
        return SimpleNamespace(mean=measures.get, median=measures.get)

    shortest = {"units": 1.0, "path_ratio": 1.0, "arc_length": -1.0, "jerk": -6.0}
    assert delays._less_smooth({"0 ms": [learner(**shortest)], "200 ms": [learner(**longer)]}) == verdict


def test_experiments_of_the_paper_are_those_whose_infants_can_have_its_body():
    assert [name for name in EXPERIMENTS if find_experiment(name).development] == list(PAPERS)

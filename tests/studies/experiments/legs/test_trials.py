"""Trials by seed, which an interruption leaves intact, and what is said of their means."""

import time
from dataclasses import dataclass

import pytest

from mimoc.studies import kept_results
from mimoc.studies.experiments.legs.intervals import change_text, direction, interval, relative_changes, sign_test
from mimoc.studies.experiments.legs.trials import FOLDER, Result, Trial, forget_trials, run_trials
from mimoc.studies.experiments.notebook import open_notebook


@dataclass(frozen=True)
class Case:
    factor: float


RUNS: list[int] = []


def multiply(case: Case, seed: int) -> Result:
    RUNS.append(seed)
    if seed == 13:
        raise KeyboardInterrupt
    return Result(values={"product": case.factor * seed})


@pytest.fixture
def notebook(tmp_path):
    RUNS.clear()
    return open_notebook("toy", tmp_path, quick=True)


def trials(seeds) -> list[Trial]:
    return [Trial(multiply, Case(2.0), seed) for seed in seeds]


def test_results_come_in_the_order_of_the_trials(notebook):
    assert [result.values["product"] for result in run_trials(notebook, trials((3, 1, 2)))] == [6.0, 2.0, 4.0]


def test_what_was_finished_is_not_repeated_after_an_interruption(notebook):
    with pytest.raises(KeyboardInterrupt):
        run_trials(notebook, trials((1, 2, 13)))
    run_trials(notebook, trials((1, 2, 3)))
    assert RUNS == [1, 2, 13, 3]


def wait(case: Case, seed: int) -> Result:
    time.sleep(seed)
    return Result(values={"waited": seed})


@pytest.mark.full
def test_an_interruption_ends_running_trials_within_seconds_and_keeps_finished_ones(tmp_path):
    def interrupt(done: int, total: int) -> None:
        raise KeyboardInterrupt

    trials = [Trial(wait, Case(1.0), seed) for seed in (0, 600, 601)]
    begin = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        run_trials(open_notebook("toy", tmp_path, quick=False, progress=interrupt), trials)
    assert time.monotonic() - begin < 30.0
    assert len(list((tmp_path / FOLDER).iterdir())) == 1
    counted: list[int] = []
    again = open_notebook("toy", tmp_path, quick=False, progress=lambda done, total: counted.append(done))
    assert run_trials(again, trials[:1])[0].values == {"waited": 0.0}
    assert counted == [1]


def test_a_trial_of_other_software_is_done_again(notebook, monkeypatch):
    run_trials(notebook, trials((1,)))
    changed = {**kept_results.software(), "studies/kept_results.py": "sha256:0"}
    monkeypatch.setattr(kept_results, "software", lambda: changed)
    run_trials(notebook, trials((1,)))
    assert RUNS == [1, 1]


def test_the_software_is_all_of_mimoc_and_its_tables():
    software = kept_results.software()
    assert {"mimoc", "mujoco", "numpy", "policies/__init__.py", "data/anthrokids.csv"} <= software.keys()
    assert not [name for name in software if name.endswith(".pyc")]


def test_another_case_is_another_trial(notebook):
    run_trials(notebook, trials((1,)))
    assert run_trials(notebook, [Trial(multiply, Case(3.0), 1)])[0].values == {"product": 3.0}


def test_a_damaged_result_is_done_again(notebook):
    run_trials(notebook, trials((1,)))
    (path,) = (notebook.folder / FOLDER).iterdir()
    path.write_text("{")
    assert run_trials(notebook, trials((1,)))[0].values == {"product": 2.0}
    assert RUNS == [1, 1]


def test_nothing_is_left_of_an_experiment_that_has_ended(notebook):
    run_trials(notebook, trials((1,)))
    forget_trials(notebook)
    assert list(notebook.folder.iterdir()) == []


def test_progress_counts_the_trials_of_an_earlier_run(tmp_path):
    RUNS.clear()
    counts = []
    run_trials(open_notebook("toy", tmp_path, quick=True), trials((1, 2)))
    notebook = open_notebook("toy", tmp_path, quick=True, progress=lambda done, total: counts.append((done, total)))
    run_trials(notebook, trials((1, 2, 3)))
    assert counts == [(1, 3), (2, 3), (3, 3)]


def test_the_interval_is_students():
    """1, 2, 3: mean 2, standard deviation 1, t of .975 with 2 degrees of freedom 4.303."""
    mean = interval([1.0, 2.0, 3.0])
    assert (mean.mean, mean.high - mean.mean) == pytest.approx((2.0, 4.3027 / 3**0.5), rel=1e-4)
    assert mean.text(1) == "2.0 (-0.5 to 4.5)"
    assert interval([5.0]).text(0) == "5 (5 to 5)"


def test_the_sign_test_is_one_sided_and_ignores_ties():
    assert sign_test([1.0] * 5) == 1 / 32
    assert sign_test([1.0, 0.0, -1.0]) == 0.75
    assert sign_test([]) == 1.0


def test_each_seed_is_compared_with_itself():
    plain, changed = [{"x": 1.0}, {"x": 3.0}, {}], [{"x": 2.0}, {"x": 3.0}, {"x": 9.0}]
    assert relative_changes(plain, changed, "x") == [0.5, 0.0]
    assert change_text([0.5, 0.0, 0.25]) == "+25% (-37% to +87%), 2 of 3"
    assert relative_changes([{"x": 0.0}], [{"x": 1.0}], "x") == []


def test_a_direction_needs_more_than_chance():
    assert direction([0.1] * 5) == "more"
    assert direction([-0.1] * 5) == "less"
    assert direction([0.1] * 4) == "unclear"
    assert direction([0.1, -0.1] * 4) == "same"
    assert direction([0.1] * 5, least=0.2) == "same"
    assert direction([]) == "unclear"

"""When the children of a cohort reach milestones."""

import csv
import shutil
import sys
from pathlib import Path
from statistics import NormalDist

import pytest
from pyarrow import parquet

from mimoc.base.errors import MimocError, MissingExtraError, SpecError
from mimoc.base.quantities import MILESTONE_AGES, measured_in
from mimoc.schema.source import dump
from mimoc.studies.cohorts.cohort import Cohort, read_cohort
from mimoc.studies.cohorts.run_jobs import run_jobs
from mimoc.studies.cohorts.store import Store
from mimoc.studies.cohorts.table import ALL, WHO, milestone_summary
from mimoc.studies.milestones.trials import TRIALS

EXAMPLE = Path(__file__).parents[3] / "examples/cohort/milestones.yaml"


def row(sit, stand=10.0, *, weight=50.0, fat=50.0, status="ok"):
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


NOTE = """
def note(work):
    seen = {"stable": bool(work.seed), "few": 3 if work.seed else None}
    return {**seen, "note": 'a, "b"', "status": "\\ud800", "body.remove": 7}
"""


@pytest.fixture(scope="module")
def finished(tmp_path_factory) -> tuple[Cohort, Path]:
    folder = tmp_path_factory.mktemp("cohort")
    (folder / "own.py").write_text(NOTE)
    runs = [{"run": {"steps": steps}} for steps in (3, 4)]
    base = {"mimoc": 1, "name": "infant", "age_months": 9}
    do = ["build", *runs, {"python": {"function": "own:note", "seeds": [0, 1]}}]
    keys = {"cohort": "small", "base": base, "vary": {"body.remove": [[], ["left_hand"]]}, "do": do}
    (folder / "cohort.yaml").write_text(dump({"mimoc": 1, **keys}))
    study, store = Cohort(folder / "cohort.yaml"), Store(folder / "out")
    store.create("small")
    run_jobs(study.jobs(), store)
    return study, store.folder


@pytest.fixture
def done(finished, tmp_path):
    study, folder = finished
    return study, Path(shutil.copytree(folder, tmp_path / "out"))


def test_csv_and_parquet_say_the_same(done):
    study, out = done
    paths = study.table(out)
    with paths[0].open(newline="") as file:
        written = [*csv.DictReader(file)]
    table = parquet.read_table(paths[1])
    assert len(written) == table.num_rows == 10
    for text, row in zip(written, table.to_pylist(), strict=True):
        assert text == {name: as_text(value) for name, value in row.items()}
    types = {name: str(table.schema.field(name).type) for name in ("length_cm", "seed", "stable", "few", "note")}
    assert types == {"length_cm": "double", "seed": "int64", "stable": "bool", "few": "int64", "note": "string"}


def as_text(value):
    if isinstance(value, bool):
        return "true" if value else "false"
    return "" if value is None else f"{value:.9g}" if isinstance(value, float) else str(value)


def test_lists_are_cells_and_options_that_differ_are_columns(done):
    study, out = done
    rows = study.rows(out)
    assert {row["body.remove"] for row in rows} == {"[]", '["left_hand"]'}
    assert [row["run.steps"] for row in rows[:5]] == [None, 3, 4, None, None]
    assert "run.policy" not in rows[0]


def test_a_measure_with_the_name_of_another_column_has_one_of_its_own(done):
    rows = done[0].rows(done[1])
    assert {row["status"] for row in rows} == {"ok"}
    assert [(row["measured.status"], row["measured.body.remove"]) for row in rows[3:5]] == [("\\ud800", 7)] * 2
    assert rows[3]["body.remove"] == "[]"


def test_jobs_that_are_not_done_or_whose_results_are_damaged_are_rows_and_are_done_then(done, here):
    study, out = done
    job = study.jobs()[3]
    (out / "results" / job.key[:2] / f"{job.key}.json").write_text("not JSON: cut off")
    assert [row["status"] for row in study.rows(out)] == ["ok"] * 3 + ["missing"] + ["ok"] * 6
    assert study.run(out, here).number("ok") == 10


def test_without_pyarrow_there_is_the_csv_and_one_clear_error(done, monkeypatch):
    study, out = done
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(MissingExtraError, match=r"pyarrow is not installed; run: pip install 'mimoc\[record\]'"):
        study.table(out)
    assert (out / "table.csv").exists()
    assert not (out / "table.parquet").exists()
    assert study.table(out, parquet=False) == [out / "table.csv"]


def test_a_folder_of_something_else_has_no_table(cohort, tmp_path):
    with pytest.raises(MimocError, match="not the folder of a cohort"):
        cohort().table(tmp_path)

"""The table of a cohort."""

import csv
import shutil
import sys
from pathlib import Path

import pytest
from pyarrow import parquet

from mimoc.base.errors import MimocError, MissingExtraError
from mimoc.schema.source import dump
from mimoc.studies.cohorts.cohort import Cohort
from mimoc.studies.cohorts.run_jobs import run_jobs
from mimoc.studies.cohorts.store import Store

NOTE = """
def note(work):
    seen = {"stable": bool(work.seed), "few": 3 if work.seed else None}
    return {**seen, "note": 'a, "b"', "status": "\\ud800", "body.remove": 7}
"""


@pytest.fixture(scope="module")
def finished(tmp_path_factory) -> tuple[Cohort, Path]:
    """Return a cohort whose jobs are done, and its folder, which is only to be read."""
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
    """Return the cohort, and a copy of its folder."""
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

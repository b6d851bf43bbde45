"""Cohorts for the tests, and an engine that needs no processes."""

import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from mimoc.schema.source import dump
from mimoc.studies.cohorts import engines
from mimoc.studies.cohorts.cohort import Cohort
from mimoc.studies.cohorts.run_jobs import run_jobs

BASE = {"mimoc": 1, "name": "infant", "age_months": 9}


@pytest.fixture
def write(tmp_path) -> Callable[..., Path]:
    """Return what writes the cohort file given as keywords."""

    def write(**keys: Any) -> Path:
        path = tmp_path / "cohort.yaml"
        path.write_text(dump({"mimoc": 1, "cohort": "small", "base": BASE, "do": ["build"], **keys}))
        return path

    return write


@pytest.fixture
def cohort(write) -> Callable[..., Cohort]:
    """Return what reads the cohort given as keywords."""
    return lambda **keys: Cohort(write(**keys))


@pytest.fixture
def here(monkeypatch) -> str:
    """Return the name of an engine that does all jobs in this process, last things first."""
    module = ModuleType("engine_of_the_tests")

    def run(jobs, store, options, done):
        for number, job in enumerate(reversed(jobs), start=1):
            run_jobs([job], store)
            done(number)

    vars(module).update(run=run, OPTIONS=(), check=lambda options: None)
    monkeypatch.setitem(sys.modules, module.__name__, module)
    monkeypatch.setattr(engines, "ENGINES", {**engines.ENGINES, "here": module.__name__})
    return "here"

"""Cohorts for the tests, and an engine that needs no processes."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from mimoc.schema.kinds import ENGINES, EngineKind
from mimoc.schema.source import dump
from mimoc.studies.cohorts.cohort import Cohort
from mimoc.studies.cohorts.run_jobs import run_jobs

BASE = {"mimoc": 1, "name": "infant", "age_months": 9}


@pytest.fixture
def write(tmp_path) -> Callable[..., Path]:
    def write(**keys: Any) -> Path:
        path = tmp_path / "cohort.yaml"
        path.write_text(dump({"mimoc": 1, "cohort": "small", "base": BASE, "do": ["build"], **keys}))
        return path

    return write


@pytest.fixture
def cohort(write) -> Callable[..., Cohort]:
    return lambda **keys: Cohort(write(**keys))


@pytest.fixture
def here() -> Iterator[str]:
    """Yield the name of an engine that does all jobs in this process, last things first."""

    def run(jobs, store, options, done):
        for number, job in enumerate(reversed(jobs), start=1):
            run_jobs([job], store)
            done(number)

    ENGINES.add(EngineKind("here", (), lambda options: None, run))
    yield "here"
    ENGINES.remove("here")

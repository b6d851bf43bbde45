"""Which tests run only in `make test-all`: arguments marked `full`, and files that need libraries of extras."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

FULL = pytest.mark.full


def full_but(quick: Iterable[Any], values: Iterable[Any]) -> list[Any]:
    """Return values of one argument of a test: those that always run, then those of `make test-all`, each once."""
    always = list(quick)
    return always + [pytest.param(value, marks=FULL) for value in values if value not in always]


def full_rows(quick: Iterable[tuple[Any, ...]], rows: Iterable[tuple[Any, ...]]) -> list[Any]:
    """Return rows of several arguments of a test, as `full_but` returns values of one."""
    always = list(quick)
    return always + [pytest.param(*row, marks=FULL) for row in rows if row not in always]


TESTS = Path(__file__).resolve().parents[1]
FILES = tuple(  # Files and folders that need them throughout; elsewhere, single tests are marked.
    TESTS / name
    for name in (
        *("consumers", "runtime/device", "runtime/test_learning.py", "render/test_triton.py", "viewer/test_live.py"),
        *(f"fuzz/test_{name}.py" for name in ("crafted_folders", "lives")),
        *("studies/experiments/test_experiments.py", "test_docstrings.py", "test_notebook.py"),
        "test_trainings_in_docs.py",
        *(f"training/test_{name}.py" for name in ("custom", "device_training", "episodes", "policies")),
        *(f"training/test_{name}.py" for name in ("sb3_vec_env", "tracking", "train_command", "trainer")),
    )
)


def needs_extras(path: Path) -> bool:
    return any(path == file or file in path.parents for file in FILES)

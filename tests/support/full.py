"""Arguments of tests of which some run only in full: they are marked `full`, which `make test-all` asks for by `-m`."""

from collections.abc import Iterable
from typing import Any

import pytest

FULL = pytest.mark.full


def full_but(quick: Iterable[Any], values: Iterable[Any]) -> list[Any]:
    """Return values of one argument of a test: those that always run, then those of `make test-all`, each once.

    Args:
        quick: What always runs.
        values: What runs in full; it may contain what always runs.
    """
    always = list(quick)
    return always + [pytest.param(value, marks=FULL) for value in values if value not in always]


def full_rows(quick: Iterable[tuple[Any, ...]], rows: Iterable[tuple[Any, ...]]) -> list[Any]:
    """Return rows of several arguments of a test, as `full_but` returns values of one."""
    always = list(quick)
    return always + [pytest.param(*row, marks=FULL) for row in rows if row not in always]

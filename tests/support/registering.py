"""Kinds that are registered for the time of a test."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

import pytest

import mimoc
from mimoc.schema.composition import recompose
from mimoc.schema.plugins import KINDS, Record


@contextmanager
def _registered(record: Record) -> Iterator[None]:
    mimoc.register(record)
    try:
        yield
    finally:
        (table,) = (table for kind, table in KINDS.values() if isinstance(record, kind))
        table.remove(record.name)
        recompose()


@pytest.fixture
def registered() -> Callable[[Record], AbstractContextManager[None]]:
    """Return what registers a record within a `with` statement."""
    return _registered

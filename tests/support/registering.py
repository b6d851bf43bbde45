"""Components that are registered for the time of a test."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

import pytest

import mimoc
from mimoc.base.kinds import Component
from mimoc.schema.base import recompose
from mimoc.schema.plugins import GROUPS


@contextmanager
def registered(*records: Component) -> Iterator[None]:
    mimoc.register(*records)
    try:
        yield
    finally:
        for record in records:
            (table,) = (table for table in GROUPS.values() if isinstance(record, table.record))
            table.remove(record.name)
        recompose()


@pytest.fixture(name="registered")
def _registered() -> Callable[..., AbstractContextManager[None]]:
    return registered

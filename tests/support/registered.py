"""Kinds that a test registers, for as long as it runs."""

from collections.abc import Iterator
from contextlib import contextmanager

from mimoc.schema import plugins
from mimoc.schema.composition import recompose


@contextmanager
def registered(*records: plugins.Record) -> Iterator[None]:
    """Have mimoc know some records; afterwards it does not."""
    plugins.register(*records)
    try:
        yield
    finally:
        for record in records:
            for kind, table in plugins.KINDS.values():
                if isinstance(record, kind):
                    table._added.pop(record.name)
        recompose()

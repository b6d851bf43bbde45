"""Kinds that others add: by entry points of installed distributions, or by a script."""

import warnings
from collections.abc import Iterator
from functools import cache
from importlib.metadata import EntryPoint

from mimoc.actuation import ACTUATIONS
from mimoc.errors import KindError
from mimoc.kinds import (
    ActuationKind,
    Kinds,
    PolicyKind,
    SceneKind,
    SenseKind,
    TaskKind,
    ToySource,
    installed_entry_points,
)
from mimoc.policies import POLICIES
from mimoc.scenes import SCENES
from mimoc.schema.composition import recompose
from mimoc.senses import SENSES
from mimoc.tasks import TASKS
from mimoc.toys import TOY_SOURCES

Record = SenseKind | ActuationKind | TaskKind | SceneKind | ToySource | PolicyKind

KINDS: dict[str, tuple[type, Kinds]] = {
    "mimoc.senses": (SenseKind, SENSES),
    "mimoc.actuation": (ActuationKind, ACTUATIONS),
    "mimoc.tasks": (TaskKind, TASKS),
    "mimoc.scenes": (SceneKind, SCENES),
    "mimoc.toys": (ToySource, TOY_SOURCES),
    "mimoc.policies": (PolicyKind, POLICIES),
}
"""The class and the table of records, by group of entry points."""


def register(*records: Record) -> None:
    """Add kinds from a script: from now on specs, bundles and commands of this process know them.

    Args:
        records: A record for each kind, such as a `TaskKind`.

    Raises:
        KindError: If something is no record, its name is taken, or its keys do not fit into the spec language.
    """
    for record in records:
        _add(record, _table_of(record))


@cache
def load_plugins() -> None:
    """Add the kinds of all installed distributions, once; one that cannot be loaded is a warning."""
    for entry_point in _entry_points():
        _load(entry_point)


def _entry_points() -> Iterator[EntryPoint]:
    found = installed_entry_points()
    for group in KINDS:
        yield from sorted(found.select(group=group), key=lambda each: each.name)


def _add(record: Record, table: Kinds, distribution: str = "") -> None:
    """Add a record to its table and to the sections that depend on it, or to none of them."""
    table.add(record, distribution)
    try:
        recompose()
    except Exception as error:  # Its classes are a stranger's; pydantic raises what it finds wrong with them.
        table.remove(record.name)
        recompose()
        raise KindError(f"the {table.what} '{record.name}' does not fit into the spec language: {error}") from error


def _load(entry_point: EntryPoint) -> None:
    """Add the record that an entry point names, or warn that this is impossible."""
    distribution = entry_point.dist.name if entry_point.dist else ""
    try:
        record = entry_point.load()
        table = _table_of(record)
        if table is not KINDS[entry_point.group][1]:
            raise KindError(f"it is a {table.what}, which does not belong to the group '{entry_point.group}'")
        _add(record, table, distribution)
    except Exception as error:  # Whatever a stranger's package does, mimoc goes on without it.
        message = f"the plug-in '{entry_point.name}' of '{distribution}' cannot be loaded: {error!r}; it is left out"
        warnings.warn(message, stacklevel=2)


def _table_of(record: Record) -> Kinds:
    for kind, table in KINDS.values():
        if isinstance(record, kind):
            return table
    names = ", ".join(kind.__name__ for kind, _ in KINDS.values())
    raise KindError(f"{record!r} is no record of a kind; pass one of {names}")

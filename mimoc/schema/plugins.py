"""Components that others add: by entry points of installed distributions, or by a script."""

import signal
import threading
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields
from functools import cache
from importlib.metadata import EntryPoint
from importlib.util import find_spec
from types import FrameType
from typing import Any, get_type_hints

from pydantic import ConfigDict, TypeAdapter, ValidationError

from mimoc.anatomy.part import PartKind, ReferencePart
from mimoc.anatomy.parts import PARTS, check_parts
from mimoc.base.errors import KindError
from mimoc.base.kinds import PLUGINS_VARIABLE, Code, Component, Registry, installed_entry_points
from mimoc.base.quantities import QUANTITIES
from mimoc.schema.base import Model, recompose
from mimoc.schema.kinds import ACTUATIONS, EXPORTERS, FORMATS, OBJECTS, POLICIES, SCENES, SENSES, TASKS, TOY_SOURCES

GROUPS: Mapping[str, Registry[Any]] = {
    "mimoc.senses": SENSES,
    "mimoc.actuation": ACTUATIONS,
    "mimoc.tasks": TASKS,
    "mimoc.scenes": SCENES,
    "mimoc.toys": TOY_SOURCES,
    "mimoc.objects": OBJECTS,
    "mimoc.parts": PARTS,
    "mimoc.policies": POLICIES,
    "mimoc.quantities": QUANTITIES,
    "mimoc.exporters": EXPORTERS,
    "mimoc.motion": FORMATS,
}
"""The components that plug-ins can add, by group of entry points."""
IMPORT_LIMIT_S = 60.0
"""Wall-clock time that a plug-in's import may take: an assumption, ten times what a first import of PyTorch takes."""


class _ImportTimeoutError(BaseException):
    """The import of a plug-in takes too long; not an `Exception`, which the plug-in's own code might catch."""


def register(*records: Component) -> None:
    """Add kinds from a script: from now on specs, bundles and commands of this process know them.

    Args:
        records: A record for each kind, such as a `TaskKind`.

    Raises:
        KindError: If something is no record, a field has the wrong type or names a module that does not exist, its
            name is taken, or its keys do not fit into the spec language.

    Example:
        >>> import mimoc
        >>> import numpy as np
        >>> from mimoc.schema.kinds import PolicyKind
        >>> def bind(env):
        ...     return lambda generator, observation: np.zeros(env.action_space.shape, np.float32)
        >>> mimoc.register(PolicyKind("limp", "does nothing", bind))
        >>> len(mimoc.evaluate(mimoc.make("reach.yaml", max_episode_steps=2), "limp", episodes=1))
        1
    """
    for record in records:
        _add(record, _table_of(record))


@cache
def load_plugins() -> None:
    """Add the kinds of all installed distributions, once; one that cannot be loaded is a warning."""
    for group in GROUPS:
        for entry_point in sorted(installed_entry_points().select(group=group), key=lambda point: point.name):
            _load(entry_point)


def _add(record: Component, table: Registry[Any], distribution: str = "") -> None:
    """Add a record to its table and to the sections that depend on it, or to none of them."""
    _check_fields(record)
    if isinstance(record, PartKind):
        check_parts(record)
    table.add(record, distribution)
    try:
        recompose()
    except Exception as error:  # Its classes are a stranger's; pydantic raises what it finds wrong with them.
        table.remove(record.name)
        recompose()
        raise KindError(f"the {table.what} '{record.name}' does not fit into the spec language: {error}") from error


def _check_fields(record: Component) -> None:
    """Check that each field of a record has its type, and that the modules it names exist."""
    types = get_type_hints(type(record), localns={"Model": Model, "ReferencePart": ReferencePart})
    for field in fields(record):
        value = getattr(record, field.name)
        key = f"{type(record).__name__}.{field.name}"
        try:
            TypeAdapter(types[field.name], config=ConfigDict(strict=True)).validate_python(value)
        except ValidationError as error:
            reason = error.errors()[0]["msg"]
            raise KindError(f"{key} is {value!r:.60}: {reason[0].lower()}{reason[1:]}") from None
        if types[field.name] in (Code, Code | None) and isinstance(value, str) and not _exists(value.partition(":")[0]):
            raise KindError(f"{key} names the module '{value}', which does not exist")


def _exists(module: str) -> bool:
    try:
        return find_spec(module) is not None
    except (ImportError, ValueError):  # Its package does not exist; it is no name.
        return False


def _load(entry_point: EntryPoint) -> None:
    """Add the record that an entry point names, or warn that this is impossible."""
    distribution = entry_point.dist.name if entry_point.dist else ""
    try:
        with _time_limit():
            record = entry_point.load()
        table = _table_of(record)
        if table is not GROUPS[entry_point.group]:
            raise KindError(f"it is a {table.what}, which does not belong to the group '{entry_point.group}'")
        _add(record, table, distribution)
    except _ImportTimeoutError:
        _warn(entry_point.name, distribution, f"importing it takes more than {IMPORT_LIMIT_S:g} s")
    except (Exception, SystemExit) as error:  # Whatever a stranger's package does, mimoc goes on without it.
        _warn(entry_point.name, distribution, str(error) if isinstance(error, KindError) else repr(error))


def _warn(name: str, distribution: str, reason: str) -> None:
    message = f"the plug-in '{name}' of '{distribution}' cannot be loaded: {reason}; it is left out"
    warnings.warn(f"{message} ({PLUGINS_VARIABLE}=none leaves out all plug-ins)", stacklevel=3)


@contextmanager
def _time_limit() -> Iterator[None]:
    """Raise `_ImportTimeoutError` after the limit, in the main thread, where alone Python can interrupt an import."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    former = signal.signal(signal.SIGALRM, _time_out)
    signal.setitimer(signal.ITIMER_REAL, IMPORT_LIMIT_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, former)


def _time_out(_signal: int, _frame: FrameType | None) -> None:
    raise _ImportTimeoutError


def _table_of(record: Component) -> Registry[Any]:
    for table in GROUPS.values():
        if isinstance(record, table.record):
            return table
    names = ", ".join(table.record.__name__ for table in GROUPS.values())
    raise KindError(f"{record!r} is no record of a kind; pass one of {names}")

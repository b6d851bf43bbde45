"""Components by name: mimoc's own, and those that plug-ins and scripts add."""

import os
import re
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import EntryPoints, distributions, entry_points
from typing import Any, TypeVar

from mimoc.base.errors import KindError, check_name

Code = str | Callable[..., Any]  # A function, or the full name of its module, and `:NAME`.

NAME = re.compile("[a-z][a-z0-9_]*")
PLUGINS_VARIABLE = "MIMOC_PLUGINS"
"""Environment variable that names the distributions whose plug-ins are used, with commas; `none` is none of them."""


@dataclass(frozen=True, slots=True)
class Component:
    """What a spec, a bundle or a command can name; each kind of components has a record with more fields."""

    name: str  # Name, unique among its kind of components.


C = TypeVar("C", bound=Component)


class Registry(Mapping[str, C]):
    """The components of one kind by name: mimoc's own, in their order, then those that were added.

    Args:
        record: The class of their records.
        what: What they are, in the singular, such as `sense`.
        builtin: Mimoc's own: records, or by name where one is imported when it is first asked for. Such a record is the
            `KIND` of the module that is named, or what a module names otherwise, as `module:NAME`.
    """

    def __init__(self, record: type[C], what: str, builtin: Mapping[str, C | str] | Iterable[C]):
        self.record = record
        self.what = what
        given: Any = builtin if isinstance(builtin, Mapping) else {record.name: record for record in builtin}
        self.builtin: Mapping[str, C | str] = given
        self._added: dict[str, tuple[C, str]] = {}

    def __getitem__(self, name: str) -> C:
        if name not in self.builtin:
            return self._added[name][0]
        record: Any = self.builtin[name]
        if not isinstance(record, str):
            return record
        module, _, attribute = record.partition(":")
        return getattr(import_module(module), attribute or "KIND")

    def __iter__(self) -> Iterator[str]:
        yield from self.builtin
        yield from sorted(self._added)

    def __len__(self) -> int:
        return len(self.builtin) + len(self._added)

    def find(self, name: str) -> C:
        """Return the record of a name, or raise an UnknownNameError."""
        check_name(self.what, name, self)
        return self[name]

    def distribution(self, name: str) -> str:
        """Return the distribution that a kind comes from, such as `mimoc`; empty if a script registered it."""
        return "mimoc" if name in self.builtin else self._added[name][1]

    def add(self, record: C, distribution: str = "") -> None:
        """Add somebody else's record, which a script may replace; KindError if its name is invalid or taken."""
        if not NAME.fullmatch(record.name):
            raise KindError(f"'{record.name}' cannot name a {self.what}; use lower-case letters, digits and '_'")
        if record.name in self and (distribution or self.distribution(record.name)):
            taken = self.distribution(record.name) or "this script"
            raise KindError(f"there is a {self.what} '{record.name}' already, from {taken}; choose another name")
        self._added[record.name] = record, distribution

    def remove(self, name: str) -> None:
        """Take out a record that was added."""
        del self._added[name]


def check_custom_object(what: str, custom: object, method: str, example: str) -> None:
    """Raise a KindError unless what a script passes instead of a record is an object with a method, not its class."""
    if isinstance(custom, type):
        raise KindError(f"{what} is the class {custom.__name__}; pass an object of it: {custom.__name__}()")
    if not callable(getattr(custom, method, None)):
        raise KindError(f"{what} is {custom!r:.60}, which has no method '{method}'; pass {example}")


def announced(group: str) -> list[str]:
    """Return the names of the kinds that installed distributions announce in a group of entry points, not loaded."""
    return sorted(point.name for point in installed_entry_points().select(group=group))


@cache
def installed_entry_points() -> EntryPoints:
    """Return the entry points of all installed distributions, or of those that `MIMOC_PLUGINS` names, looked up once.

    A name there that no distribution with entry points of mimoc has is a warning.
    """
    wanted = os.environ.get(PLUGINS_VARIABLE)
    if wanted is None:
        installed: Any = entry_points()  # Python 3.11's has another type, with the same `select`.
        return installed
    names = {_normalized(name) for name in wanted.split(",") if name.strip()} - {"none"}
    points = [point for package in distributions() for point in package.entry_points] if names else []
    ours = {point: _normalized(point.dist.name) for point in points if point.dist and point.group.startswith("mimoc.")}
    for name in sorted(names - set(ours.values())):
        warnings.warn(f"{PLUGINS_VARIABLE}: no installed package '{name}' has plug-ins for mimoc", stacklevel=2)
    return EntryPoints(point for point, name in ours.items() if name in names)


def function_of(code: Code, name: str) -> Callable[..., Any]:
    """Return *code* itself, or what has this name in the module, or raise a KindError if somebody else's lacks it."""
    if not isinstance(code, str):
        return code
    module, _, function = code.partition(":")
    name = function or name
    if module.startswith("mimoc."):
        return getattr(import_module(module), name)
    try:
        return getattr(import_module(module), name)
    except (Exception, SystemExit) as error:  # Whatever a plug-in's module does when it is imported.
        raise KindError(f"the plug-in module '{module}' has no usable function '{name}': {error!r}") from error


def _normalized(distribution: str) -> str:
    """Return the name of a distribution in its canonical form (PEP 503)."""
    return re.sub(r"[-_.]+", "-", distribution.strip()).lower()

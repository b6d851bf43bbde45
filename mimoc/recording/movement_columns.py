"""Movement as data: the table of all columns of where an infant is, how it moves, what it touches and what drives it.

The recorder, exporters, quantities and the documentation read these columns from here.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any

import numpy as np

from mimoc.base.errors import check_name
from mimoc.base.kinds import Code, function_of
from mimoc.recording.movement_column import Column, Group, Values

if TYPE_CHECKING:  # Importing the names of the groups, as the command line does, must not load MuJoCo.
    from mimoc.runtime.infant import Infant


@dataclass(frozen=True, slots=True)
class ColumnGroup:
    """Columns that are recorded together or not at all."""

    name: str
    about: str  # What they say, for help and documentation.
    bind: Code
    """`bind_NAME(env) -> Group`: looks up in an infant's model what they read; or the module that defines it."""


_BIND = "mimoc.recording.movement_groups"
_OWN = (
    ColumnGroup("keypoints", "the 25 keypoints of BODY_25", _BIND),
    ColumnGroup("parts", "place, velocity and speed of hands, feet, head, trunk and the whole body", _BIND),
    ColumnGroup("objects", "place, velocity and speed of the objects of the spec", _BIND),
    ColumnGroup("gaze", "where the eyes look, and at what", _BIND),
    ColumnGroup("contacts", "what each part of the body touches, contact forces and ground reaction", _BIND),
    ColumnGroup("joints", "angles of joints, and torques of motors or muscles about them", _BIND),
    ColumnGroup("actuators", "activation of each muscle or motor", _BIND),
)
GROUPS: Mapping[str, ColumnGroup] = {group.name: group for group in _OWN}
"""All movement columns, in the order in which tables show them."""
ALL, NO_GROUP = "all", "none"


def groups_named(text: str) -> tuple[str, ...]:
    """Return the groups that a text such as `keypoints,contacts`, `all` or `none` names."""
    if text in (ALL, NO_GROUP):
        return tuple(GROUPS) if text == ALL else ()
    return checked_groups([name.strip() for name in text.split(",")])


def checked_groups(names: Sequence[str]) -> tuple[str, ...]:
    """Return groups in the order of the table, each once, or raise an UnknownNameError if there is no such one."""
    for name in names:
        check_name("group of movement columns", name, GROUPS)
    return tuple(name for name in GROUPS if name in names)


class Samples:
    """What is kept of some times, until the values of all columns are computed."""

    def __init__(self, groups: Sequence[Group], room: int):
        self.groups, self._rows = groups, 0
        self._fields = [field for group in groups for field in group.fields]
        self._flat = [field.reshape(-1) for field in self._fields]  # Views, which show every later state of the data.
        self._moments = [group.moment for group in groups if group.moment]
        self._kept = np.empty((room, sum(map(len, self._flat))))
        self._kept_moments: list[list[Any]] = [[] for _ in self._moments]

    def add(self) -> None:
        """Keep this moment."""
        if self._flat:
            np.concatenate(self._flat, out=self._kept[self._rows])
        for kept, moment in zip(self._kept_moments, self._moments, strict=True):
            kept.append(moment())
        self._rows += 1

    def values(self) -> Values:
        """Return the values of all columns at all times."""
        ends = np.cumsum([len(flat) for flat in self._flat])
        kept = np.split(self._kept[: self._rows], ends[:-1], axis=1) if self._flat else []
        fields = iter([rows.reshape(-1, *field.shape) for rows, field in zip(kept, self._fields, strict=True)])
        moments = iter(self._kept_moments)
        values = [
            group.values([*islice(fields, len(group.fields))], next(moments) if group.moment else ())
            for group in self.groups
        ]
        named = [item.texts for item in values if item.texts]
        texts = [sum(row, ()) for row in zip(*named, strict=True)] if named else [()] * self._rows
        return Values(np.hstack([item.numbers for item in values]), texts)


class MovementReader:
    """Reads movement columns of one infant, which may grow meanwhile.

    To copy what columns need takes little time in each control step; values are computed for many steps at once.
    """

    def __init__(self, env: "Infant", groups: Sequence[str] = tuple(GROUPS)):
        self._env, self._names = env, checked_groups(groups)
        self._bind()
        columns = [column for group in self._groups for column in group.columns]
        self.numbers = tuple(column for column in columns if not column.is_text)
        """The columns of numbers, in the order of `Values.numbers`."""
        self.texts = tuple(column for column in columns if column.is_text)
        """Those of texts."""

    @property
    def columns(self) -> tuple[Column, ...]:
        """All columns: those of numbers, then those of texts."""
        return self.numbers + self.texts

    def add(self, samples: list[Samples], room: int) -> None:
        """Keep this moment with those before, for which there is room; one of the samples for each body that it had."""
        if self._env.data is not self._data:
            self._bind()
        if not samples or samples[-1].groups is not self._groups:
            samples.append(Samples(self._groups, room))
        samples[-1].add()

    def read(self) -> dict[str, float | str]:
        """Return the values of this moment by name of the column."""
        samples = list[Samples]()
        self.add(samples, 1)
        values = samples[0].values()
        columns = (column.name for column in self.columns)
        return dict(zip(columns, (*values.numbers[0].tolist(), *values.texts[0]), strict=True))

    def _bind(self) -> None:
        self._data = self._env.data
        groups = [bind_group(name, self._env) for name in self._names]
        self._groups = [group for group in groups if group.columns]


def values_of(samples: Sequence[Samples]) -> Values:
    """Return the values of all columns at all times."""
    values = [item.values() for item in samples]
    return Values(np.concatenate([item.numbers for item in values]), [row for item in values for row in item.texts])


def bind_group(name: str, env: "Infant") -> Group:
    """Look up in an infant's model what the columns of a group read."""
    return function_of(GROUPS[name].bind, f"bind_{name}")(env)

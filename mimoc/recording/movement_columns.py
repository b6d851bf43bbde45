"""Movement as data: reads the movement columns of an infant while it acts."""

from collections.abc import Sequence
from itertools import islice
from typing import Any

import numpy as np

from mimoc.base.errors import check_name
from mimoc.base.quantity import Quantity
from mimoc.recording.movement_groups import BIND, Group, Values
from mimoc.runtime.infant import Infant
from mimoc.schema.kinds import MOVEMENT_GROUPS


def groups_named(text: str) -> tuple[str, ...]:
    """Return the groups that a text such as `keypoints,contacts`, `all` or `none` names."""
    if text in ("all", "none"):
        return tuple(MOVEMENT_GROUPS) if text == "all" else ()
    return checked_groups([name.strip() for name in text.split(",")])


def checked_groups(names: Sequence[str]) -> tuple[str, ...]:
    """Return groups in the order of the table, each once, or raise an UnknownNameError if there is no such one."""
    for name in names:
        check_name("group of movement columns", name, MOVEMENT_GROUPS)
    return tuple(name for name in MOVEMENT_GROUPS if name in names)


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

    def __init__(self, infant: Infant, groups: Sequence[str] = tuple(MOVEMENT_GROUPS)):
        self._infant, self._names = infant, checked_groups(groups)
        self._bind()
        columns = [column for group in self._groups for column in group.columns]
        self.numbers = tuple(column for column in columns if not column.is_text)
        """The columns of numbers, in the order of `Values.numbers`."""
        self.texts = tuple(column for column in columns if column.is_text)
        """Those of texts."""

    @property
    def columns(self) -> tuple[Quantity, ...]:
        """All columns: those of numbers, then those of texts."""
        return self.numbers + self.texts

    def add(self, samples: list[Samples], room: int) -> None:
        """Keep this moment with those before, for which there is room; one of the samples for each body that it had."""
        if self._infant.data is not self._data:
            self._bind()
        if not samples or samples[-1].groups is not self._groups:
            samples.append(Samples(self._groups, room))
        samples[-1].add()

    def read(self) -> dict[str, float | str]:
        """Return the values of this moment by name of the column."""
        samples = list[Samples]()
        self.add(samples, 1)
        values = samples[0].values()
        names = (column.name for column in self.columns)
        return dict(zip(names, (*values.numbers[0].tolist(), *values.texts[0]), strict=True))

    def _bind(self) -> None:
        self._data = self._infant.data
        groups = [BIND[name](self._infant) for name in self._names]
        self._groups = [group for group in groups if group.columns]

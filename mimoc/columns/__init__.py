"""Movement as data: the table of all columns of where an infant is, how it moves, what it touches and what drives it.

The recorder, exporters, quantities and the documentation read these columns from here.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import NamedTuple

import numpy as np

from mimoc.base.errors import check_name
from mimoc.columns.column import Column, FloatArray, Group, Sample, Values
from mimoc.columns.forces import bind_actuators, bind_contacts, bind_joints
from mimoc.columns.places import bind_gaze, bind_keypoints, bind_parts
from mimoc.runtime.env import InfantEnv

__all__ = ["GROUPS", "Column", "ColumnGroup", "Moment", "MovementReader", "checked_groups", "groups_named", "values_of"]


@dataclass(frozen=True, slots=True)
class ColumnGroup:
    """Columns that are recorded together or not at all."""

    name: str
    about: str
    """What they say, for help and documentation."""
    bind: Callable[[InfantEnv], Group]
    """Looks up in an infant's model what they read."""


_OWN = (
    ColumnGroup("keypoints", "the 25 keypoints of BODY_25", bind_keypoints),
    ColumnGroup("parts", "place, velocity and speed of hands, feet, head, trunk and the whole body", bind_parts),
    ColumnGroup("gaze", "where the eyes look, and at what", bind_gaze),
    ColumnGroup("contacts", "what each part of the body touches, contact forces and ground reaction", bind_contacts),
    ColumnGroup("joints", "angles of joints, and torques of motors or muscles about them", bind_joints),
    ColumnGroup("actuators", "activation of each muscle or motor", bind_actuators),
)
GROUPS: Mapping[str, ColumnGroup] = {group.name: group for group in _OWN}
"""All movement columns, in the order in which tables show them."""
ALL, NO_GROUP = "all", "none"


def groups_named(text: str) -> tuple[str, ...]:
    """Return the groups that a text such as `keypoints,contacts`, `all` or `none` names.

    Raises:
        UnknownNameError: If there is no such group.
    """
    if text in (ALL, NO_GROUP):
        return tuple(GROUPS) if text == ALL else ()
    return checked_groups([name.strip() for name in text.split(",")])


def checked_groups(names: Sequence[str]) -> tuple[str, ...]:
    """Return groups in the order of the table, each once, or raise an UnknownNameError if there is no such one."""
    for name in names:
        check_name("group of movement columns", name, GROUPS)
    return tuple(name for name in GROUPS if name in names)


class Moment(NamedTuple):
    """What columns need of one moment."""

    groups: Sequence[Group]
    """Bound to the model of that moment."""
    samples: Sequence[Sample]


class MovementReader:
    """Reads movement columns of one infant, which may grow meanwhile.

    To copy what columns need takes little time in each control step; values are computed for many steps at once.
    """

    def __init__(self, env: InfantEnv, groups: Sequence[str] = tuple(GROUPS)):
        """Bind columns to an infant.

        Args:
            env: The infant.
            groups: Names of groups.

        Raises:
            UnknownNameError: If there is no such group.
        """
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

    def sample(self) -> Moment:
        """Return what the columns need of this moment."""
        if self._env.data is not self._data:
            self._bind()
        return Moment(self._groups, [group.sample() for group in self._groups])

    def _bind(self) -> None:
        self._data = self._env.data
        self._groups = [GROUPS[name].bind(self._env) for name in self._names]


def values_of(moments: Sequence[Moment]) -> Values:
    """Return the values of all columns at some moments."""
    numbers, texts = list[FloatArray](), list[tuple[str, ...]]()
    for _, alike in groupby(moments, key=lambda moment: id(moment.groups)):
        same = list(alike)
        samples = zip(*(moment.samples for moment in same), strict=True)
        values = [group.values(item) for group, item in zip(same[0].groups, samples, strict=True)]
        numbers.append(np.hstack([np.empty((len(same), 0)), *(item.numbers for item in values)]))
        named = [item.texts for item in values if item.texts]
        texts += [sum(row, ()) for row in zip(*named, strict=True)] if named else [()] * len(same)
    return Values(np.concatenate(numbers), texts)

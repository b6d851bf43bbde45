"""Movement as data: the table of all columns of where an infant is, how it moves, what it touches and what drives it.

The recorder, exporters, quantities and the documentation read these columns from here.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from mimoc.base.errors import check_name
from mimoc.base.kinds import Code

__all__ = ["ALL", "GROUPS", "ColumnGroup", "checked_groups", "groups_named"]


@dataclass(frozen=True, slots=True)
class ColumnGroup:
    """Columns that are recorded together or not at all."""

    name: str
    about: str
    """What they say, for help and documentation."""
    bind: Code
    """`bind_NAME(env) -> Group`: looks up in an infant's model what they read; or the module that defines it."""


_PLACES, _FORCES = "mimoc.recording.movement_columns.places", "mimoc.recording.movement_columns.forces"
_OWN = (
    ColumnGroup("keypoints", "the 25 keypoints of BODY_25", _PLACES),
    ColumnGroup("parts", "place, velocity and speed of hands, feet, head, trunk and the whole body", _PLACES),
    ColumnGroup("objects", "place, velocity and speed of the objects of the spec", _PLACES),
    ColumnGroup("gaze", "where the eyes look, and at what", _PLACES),
    ColumnGroup("contacts", "what each part of the body touches, contact forces and ground reaction", _FORCES),
    ColumnGroup("joints", "angles of joints, and torques of motors or muscles about them", _FORCES),
    ColumnGroup("actuators", "activation of each muscle or motor", _FORCES),
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

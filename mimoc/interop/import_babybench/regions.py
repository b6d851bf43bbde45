"""BabyBench's body regions, with individual switches, and mimoc's muscle groups."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from mimoc.base.errors import suggestion
from mimoc.interop.settings import Settings, named
from mimoc.schema.base import shown
from mimoc.schema.names import PAIRED_GROUPS, SIDES, STRENGTH_GROUPS

_WHOLE = {
    "neck": ("neck", "head"),
    "trunk": ("trunk", "body", "torso"),
    "eyes": ("eyes", "eye"),
    **{pair: (pair, pair.removesuffix("s")) for pair in PAIRED_GROUPS},
}
"""Names of each group."""
_PARTS = {
    "neck": ("face",),
    "trunk": ("back", "belly", "chest", "hip", "hips"),
    "arms": ("elbows", "forearms", "lower_arms", "shoulders", "upper_arms"),
    "hands": ("finger", "fingers", "palms", "thumbs", "wrists"),
    "legs": ("ankles", "feet", "foot", "knees", "lower_legs", "thighs", "toe", "toes", "upper_legs"),
}
"""Names of regions that are only part of a group in mimoc, by that group."""


@dataclass(frozen=True, slots=True)
class Region:
    """The meaning of a region's name."""

    groups: tuple[str, ...]
    """Single groups: for `arms`, those of both sides."""
    rank: int
    """Specificity: 0 for a part of a group, 1 for a pair of groups, 2 for a single group."""


@dataclass(frozen=True, slots=True)
class Switch:
    """A key such as `act_fingers`."""

    key: str
    on: bool
    region: Region


def read_groups(
    settings: Settings,
    prefix: str,
    states: tuple[str, str],
    *,
    default: bool = True,
    merge: Callable[[Iterable[bool]], bool] = any,
    beside: Iterable[str] = (),
    always: frozenset[str] = frozenset(),
) -> tuple[list[Switch], frozenset[str]]:
    """Return the switches of regions and the single groups that these enable; add notes on what has no counterpart.

    Args:
        settings: The configuration.
        prefix: Prefix of the keys, such as `act_`.
        states: Description of a disabled and of an enabled group.
        default: Value of a group without a switch.
        merge: How to combine the switches of a group's parts: `any` or `all`.
        beside: Keys with the same prefix that are not switches.
        always: Groups that are enabled whatever the switches are.
    """
    switched = []
    for key in settings.keys(prefix):
        name = key.removeprefix(prefix).lower()
        if key in beside:
            continue
        if name not in REGIONS:
            settings.note(key, f"no counterpart; mimoc has no region '{shown(name)}', {suggestion(name, REGIONS)}")
        elif (on := settings.flag(key)) is not None:
            switched.append(Switch(key, on, REGIONS[name]))
    enabled = always | {group for group in SINGLE_GROUPS if merge(_values(group, switched, default))}
    for switch in switched:
        against = [group for group in switch.region.groups if (group in enabled) != switch.on]
        if against and switch.region.rank == 0:
            group, word = " and ".join(named(against)), "true" if switch.on else "false"
            message = f"has no counterpart; in mimoc this is part of '{group}', {states[not switch.on]}"
            settings.note(switch.key, f"{word} {message}")
    return switched, enabled


def _values(group: str, switched: Iterable[Switch], default: bool) -> list[bool]:
    of_group = [switch for switch in switched if group in switch.region.groups]
    whole = [switch for switch in of_group if switch.region.rank > 0]
    rank = max((switch.region.rank for switch in whole), default=0)
    values = [switch.on for switch in whole if switch.region.rank == rank] or [default]
    return values + [switch.on for switch in of_group if switch.region.rank == 0]


def _regions() -> dict[str, Region]:
    regions = {}
    for rank, table in ((1, _WHOLE), (0, _PARTS)):
        for group, names in table.items():
            for name in names:
                regions[name] = Region(PAIRED_GROUPS.get(group, (group,)), rank)
                if group in PAIRED_GROUPS:
                    one = {"feet": "foot", "toes": "toe", "fingers": "finger"}.get(name, re.sub("s$", "", name))
                    for form, side in {f"{side}_{form}": side for side in SIDES for form in (name, one)}.items():
                        regions[form] = Region((f"{side}_{group.removesuffix('s')}",), 2 * rank)
    return regions


REGIONS = _regions()
"""All names of regions."""
SINGLE_GROUPS = tuple(group for group in STRENGTH_GROUPS if group not in PAIRED_GROUPS)

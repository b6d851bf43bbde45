"""BabyBench's senses, and the regions of the body that its keys switch."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from mimoc.base.errors import suggestion
from mimoc.compat.settings import Settings, named, plain
from mimoc.schema.base import shown
from mimoc.schema.names import PAIRED_GROUPS, SIDES, STRENGTH_GROUPS

PROPRIOCEPTION = ("velocity", "torque", "limits", "actuation")
QUANTITIES = {
    "force_vector": "force_vector",
    "force": "force_vector",
    "force_vector_global": "force_vector_global",
    "normal": "normal",
    "normal_force": "normal",
}
RESPONSES = {"linear": "linear", "nearest": "nearest", "spread_linear": "linear", "spread_exponential": "linear"}
NO_RESPONSE = {"spread_exponential": "no counterpart; converted to spread_linear"}
DENSITIES = (0.1, 10.0)
"""Range of the density of skin points in mimoc."""
MAX_PX = 2048
FOVY_DEG = (1.0, 170.0)


def read_senses(settings: Settings) -> dict[str, Any]:
    """Return the section `senses` of a spec."""
    vestibular = {} if _switch(settings, "vestibular") else None
    senses = {"proprioception": _proprioception(settings), "vestibular": vestibular}
    senses |= {"touch": _touch(settings), "vision": _vision(settings)}
    return {name: sense for name, sense in senses.items() if sense is not None}


def _switch(settings: Settings, *names: str) -> bool | None:
    forms = [form for name in names for form in (name, f"{name}_active", f"{name}_on", f"{name}_enabled")]
    return settings.flag(*forms, *(f"use_{name}" for name in names))


def _proprioception(settings: Settings) -> dict[str, Any] | None:
    if _switch(settings, "proprioception", "proprio") is False:
        settings.ignore("proprioception_", "proprio_")
        return None
    felt = {name: settings.flag(f"proprio_{name}", f"proprioception_{name}") for name in PROPRIOCEPTION}
    for name, wanted in felt.items():
        if wanted is False and (key := settings.find(f"proprio_{name}")):
            settings.note(key, "excluded here; BabyBench's code ignores this key and includes it")
    include = [name for name, wanted in felt.items() if wanted is not False]
    return {} if len(include) == len(PROPRIOCEPTION) else {"include": include}


def _touch(settings: Settings) -> dict[str, Any] | None:
    on = _switch(settings, "touch")
    scale = settings.find("touch_scale")
    if on is False or (scale and settings.value(scale) in (0, 0.0) and settings.value(scale) is not False):
        settings.ignore("touch_")
        return None
    density = _density(settings)
    quantity = settings.choice("touch_function", "touch_quantity", meanings=QUANTITIES)
    key = settings.find("touch_response", "touch_response_function")
    response = settings.choice(key, meanings=RESPONSES) if key else None
    if key and (word := plain(settings.value(key))) in NO_RESPONSE:
        settings.note(key, NO_RESPONSE[word])
    regions = _skin(settings)
    said = {"density": density, "quantity": quantity, "response": response, "regions": regions}
    given = {key: value for key, value in said.items() if value is not None}
    return None if regions == [] or not (on or given) else given


def _density(settings: Settings) -> float | None:
    """Return the density of skin points that corresponds to a scale of their distances."""
    key = settings.find("touch_scale", "touch_scales")
    scale = settings.number(key, low=0.001, high=1000) if key else None
    if key is None or scale is None or scale == 1:
        return None
    lowest, highest = DENSITIES
    density = float(f"{min(max(scale**-2, lowest), highest):.4g}")
    limit = "" if lowest <= scale**-2 <= highest else f", mimoc's {'minimum' if scale > 1 else 'maximum'}"
    settings.note(key, f"interpreted as a factor of the distance between skin points: density {density:g}{limit}")
    return density


def _skin(settings: Settings) -> list[str] | None:
    beside = {"touch_function", "touch_quantity", "touch_scale", "touch_scales"}
    beside |= {"touch_response", "touch_response_function", "touch_active", "touch_on", "touch_enabled"}
    regions, with_skin = read_groups(settings, "touch_", ("which has none", "which has skin"), beside=beside)
    return named(with_skin) if regions and with_skin != set(SINGLE_GROUPS) else None


def _vision(settings: Settings) -> dict[str, Any] | None:
    on = _switch(settings, "vision")
    if on is False:
        settings.ignore("vision_")
        return None
    size_px, width_px, height_px = (
        settings.whole(*keys, low=1, high=MAX_PX)
        for keys in (("vision_resolution", "vision_size"), ("vision_width",), ("vision_height",))
    )
    fovy_deg = settings.number("vision_fovy", "vision_fov", low=FOVY_DEG[0], high=FOVY_DEG[1])
    said = {"width_px": width_px or size_px, "height_px": height_px or size_px, "fovy_deg": fovy_deg}
    given = {key: value for key, value in said.items() if value is not None}
    return {**given, "acuity": "off"} if on or given else None


_WHOLE = {
    "neck": ("neck", "head"),
    "trunk": ("trunk", "body", "torso"),
    "eyes": ("eyes", "eye"),
    **{pair: (pair, pair.removesuffix("s")) for pair in PAIRED_GROUPS},
}
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

    Keys begin with *prefix*, such as `act_`, but for *beside*, which are no switches; *states* describe a disabled and
    an enabled group, *merge* (`any` or `all`) combines the switches of a group's parts, and *always* are enabled in any
    case.
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
SINGLE_GROUPS = tuple(group for group in STRENGTH_GROUPS if group not in PAIRED_GROUPS)

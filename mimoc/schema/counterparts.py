"""Counterparts of a child: the same one without what impairs it, and whether its right side mirrors its left."""

import json
import re
from dataclasses import replace
from typing import Any

from mimoc.base.errors import MimocError, check_name
from mimoc.schema.infant import InfantSpec, healthy
from mimoc.schema.world import WorldPlan

HEALTHY = "healthy"
BESIDE = (HEALTHY,)  # The counterparts that can stand beside a child.
ELSEWHERE = {"name", "scene", "task"}  # Sections that say nothing of a body.
_SIDE = re.compile(r"(?<![A-Za-z])(left|right)(?![A-Za-z])")


def counterpart(spec: InfantSpec, beside: str) -> InfantSpec:
    """Return the child that stands beside another: `healthy` is the same one without impairments, at all its strength.

    Raises:
        UnknownNameError: If there is no such counterpart.
        SpecError: If there is no such child.
        MimocError: If it is the same child, because nothing impairs it.

    Example:
        >>> import mimoc
        >>> from mimoc.schema.counterparts import counterpart
        >>> spec = mimoc.InfantSpec(mimoc=1, name="kim", age_months=6, impairments={"weakness": {"right_arm": 0.05}})
        >>> counterpart(spec, "healthy").impairments is None
        True
    """
    check_name("child to stand beside", beside, BESIDE)
    other = _unimpaired(spec)
    if other == spec:
        raise MimocError(f"{spec.name}: nothing impairs this child; give it impairments, or leave --beside out")
    return other


def world_counterpart(plan: WorldPlan, beside: str) -> WorldPlan:
    """Return a world whose infants are the counterparts of those in another, as `counterpart` says.

    Raises:
        UnknownNameError: If there is no such counterpart.
        MimocError: If it is the same world, because nothing impairs a child in it.
    """
    check_name("child to stand beside", beside, BESIDE)
    infants = {name: _unimpaired(spec) for name, spec in plan.infants.items()}
    if infants == plan.infants:
        raise MimocError(f"{plan.spec.name}: nothing impairs a child of this world; leave --beside out")
    return replace(plan, infants=infants)


def _unimpaired(spec: InfantSpec) -> InfantSpec:
    """Return the same child without impairments, at all its strength."""
    return healthy(spec).with_(actuation={"strength": None})


def exchanged(text: str) -> str:
    """Return a text with left and right exchanged in its names and words.

    Example:
        >>> from mimoc.schema.counterparts import exchanged
        >>> exchanged("right arm, left_hand")
        'left arm, right_hand'
    """
    return _SIDE.sub(lambda side: {"left": "right", "right": "left"}[side[1]], text)


def has_like_sides(spec: InfantSpec) -> bool:
    """Return whether a spec says of the right side of a body what it says of the left.

    Example:
        >>> import mimoc
        >>> from mimoc.schema.counterparts import has_like_sides
        >>> spec = mimoc.InfantSpec(mimoc=1, name="kim", age_months=6)
        >>> has_like_sides(spec), has_like_sides(spec.with_(actuation={"strength": {"right_arm": 0.05}}))
        (True, False)
    """
    text = spec.model_dump_json(exclude=ELSEWHERE)
    return _sorted(json.loads(text)) == _sorted(json.loads(exchanged(text)))


def _sorted(value: Any) -> Any:
    """Return a value whose lists of names, such as bodies to remove, are in one order."""
    if isinstance(value, dict):
        return {key: _sorted(item) for key, item in value.items()}
    if isinstance(value, list) and all(isinstance(item, str) for item in value):
        return sorted(value)
    return [_sorted(item) for item in value] if isinstance(value, list) else value

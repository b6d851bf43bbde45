"""The record of parts of the body that belong together."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from mimoc.anatomy.part import ReferencePart
from mimoc.base.kinds import Code


@dataclass(frozen=True, slots=True, eq=False)
class PartKind:
    """Parts of the body that belong together: a tail, a pair of wings, other hands."""

    name: str
    """Name in the spec's `body.extra`, or value of its `body.hands`."""
    about: str
    """One sentence for help."""
    parts: "tuple[ReferencePart, ...]"
    """Their joints, geoms and motors at 18 months, parents first; a name with `{side}` is on both sides."""
    shape: Code
    """`shape(proportions) -> Dimensions`: sizes and places of the geoms, and places of the parts, of the right side."""
    replaces: Literal["hands"] | None = None
    """What it is in place of; None is an addition. Hands begin with `{side}_hand`, which is on `{side}_lower_arm`."""
    excluded: tuple[tuple[str, str], ...] = ()
    """Pairs of bodies without contacts."""
    masses_kg: Mapping[str, float] = field(default_factory=dict)
    """Masses at 18 months that geoms of other parts have with these, where they are not the usual ones."""

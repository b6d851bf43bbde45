"""Assembly of a complete anatomy from the tables, for a kind of hands and with or without joints of the chest."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from types import MappingProxyType

from mimoc.body import anatomy, five_finger, mitten
from mimoc.body.figures import GeomFigures, MotorFigures, Part
from mimoc.body.motors import CHEST_MOTORS

Sided = tuple[tuple[str, Part], ...]
"""Side (empty for the middle) and part."""

RIGHT_THEN_LEFT = ("right", "left")
LEFT_THEN_RIGHT = ("left", "right")
IN_ORDER_OF_MOTORS = ("trunk", "head", "eyes", "arms", "legs")
"""MIMo lists the motors of the head and the eyes before those of the arms."""


@dataclass(frozen=True, eq=False)
class Anatomy:
    """A reference body: everything that does not depend on age.

    Compared by identity, since `assemble` returns the same one each time, so that it is a quick key of a cache.
    """

    hands: str
    """`mitten` or `five_finger`."""
    parts: Sided
    """Side (empty for the midline) and part, parents first, in MIMo's order."""
    motors: tuple[tuple[str, MotorFigures], ...]
    """Side and motor, in MIMo's order."""
    excluded: tuple[tuple[str, str], ...]
    """Pairs of bodies without contacts."""

    @cached_property
    def geoms(self) -> Mapping[str, GeomFigures]:
        """All geoms by name with `{side}`."""
        return MappingProxyType({geom.name: geom for _, part in self.parts for geom in part.geoms})

    @property
    def follows(self) -> frozenset[str]:
        """Names of the measurements that this body depends on."""
        own = {name for _, part in self.parts for name in part.follows}
        return frozenset(own.union(*((*geom.follows, *geom.placed_by) for geom in self.geoms.values())))


@cache
def assemble(hands: str, chest_joint: bool) -> Anatomy:
    """Return the anatomy with these hands, and with or without MIMo's two joints of the chest."""
    sections = _sections(hands == "five_finger", chest_joint)
    motors = (
        (side, motor) for section in IN_ORDER_OF_MOTORS for side, part in sections[section] for motor in part.motors
    )
    rooted = five_finger.EXCLUDED if hands == "five_finger" else ()
    sided = tuple((a.format(side=side), b.format(side=side)) for side in RIGHT_THEN_LEFT for a, b in rooted)
    parts = tuple(_attached_to("", sum(sections.values(), ())))
    return Anatomy(hands, parts, tuple(motors), (*anatomy.EXCLUDED, *sided))


def _sections(five: bool, chest_joint: bool) -> dict[str, Sided]:
    """Return the parts of each section of the body, in MIMo's order of bodies."""
    hand = five_finger.HAND if five else mitten.HAND
    foot = five_finger.FOOT if five else mitten.FOOT
    toes = five_finger.TOES if five else dict.fromkeys(RIGHT_THEN_LEFT, mitten.TOES)
    sections = {
        "trunk": tuple(("", _with_joints(part) if chest_joint else part) for part in anatomy.TRUNK),
        "arms": _sided((*anatomy.ARM, *hand), RIGHT_THEN_LEFT),
        "head": tuple(("", part) for part in anatomy.HEAD),
        "eyes": _sided(anatomy.EYE, LEFT_THEN_RIGHT),
        "legs": sum((_sided((*anatomy.LEG, *foot, *toes[side]), (side,)) for side in RIGHT_THEN_LEFT), ()),
    }
    masses_kg = five_finger.MASSES_KG if five else {}
    return {
        section: tuple((side, _with_masses(part, masses_kg)) for side, part in parts)
        for section, parts in sections.items()
    }


def _sided(parts: Iterable[Part], sides: Iterable[str]) -> Sided:
    parts = tuple(parts)
    return tuple((side, part) for side in sides for part in parts)


def _attached_to(parent: str, parts: Sided) -> Iterator[tuple[str, Part]]:
    """Yield the parts on a parent, each followed by all on it: MuJoCo numbers bodies and joints like that."""
    for side, part in parts:
        if (part.parent or "").format(side=side) == parent:
            yield side, part
            yield from _attached_to(part.name.format(side=side), parts)


def _with_joints(part: Part) -> Part:
    """Return the chest with its joints, and any other part as it is."""
    return replace(part, joints=anatomy.CHEST_JOINTS, motors=CHEST_MOTORS) if part.name == "chest" else part


def _with_masses(part: Part, masses_kg: Mapping[str, float]) -> Part:
    geoms = tuple(replace(geom, mass_kg=masses_kg.get(geom.name, geom.mass_kg)) for geom in part.geoms)
    return replace(part, geoms=geoms)

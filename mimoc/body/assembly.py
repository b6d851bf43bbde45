"""Assembly of a complete anatomy from the tables, for a kind of hands and with or without joints of the chest."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache
from types import MappingProxyType

from mimoc.body import anatomy, five_finger, mitten, motors
from mimoc.body.figures import GeomFigures, MotorFigures, Part

RIGHT_THEN_LEFT = ("right", "left")


@dataclass(frozen=True, slots=True)
class Anatomy:
    """A reference body: everything that does not depend on age."""

    hands: str
    """`mitten` or `five_finger`."""
    parts: tuple[tuple[str, Part], ...]
    """Side (empty for the midline) and part, parents first, in MIMo's order."""
    motors: tuple[tuple[str, MotorFigures], ...]
    """Side and motor, in MIMo's order."""
    excluded: tuple[tuple[str, str], ...]
    """Pairs of bodies without contacts."""

    @property
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
    five = hands == "five_finger"
    masses_kg = five_finger.MASSES_KG if five else {}
    parts = tuple((side, _with_masses(part, masses_kg)) for side, part in _parts(five, chest_joint))
    rooted = five_finger.EXCLUDED if five else ()
    sided = tuple((a.format(side=side), b.format(side=side)) for side in RIGHT_THEN_LEFT for a, b in rooted)
    return Anatomy(hands, parts, tuple(_motors(five, chest_joint)), (*anatomy.EXCLUDED, *sided))


def _parts(five: bool, chest_joint: bool) -> Iterator[tuple[str, Part]]:
    *trunk, chest = anatomy.TRUNK
    chest = replace(chest, joints=anatomy.CHEST_JOINTS) if chest_joint else chest
    hand = five_finger.HAND if five else mitten.HAND
    foot = five_finger.FOOT if five else mitten.FOOT
    yield from (("", part) for part in (*trunk, chest))
    for side in RIGHT_THEN_LEFT:
        yield from ((side, part) for part in (*anatomy.ARM, *hand))
    yield from (("", part) for part in anatomy.HEAD)
    for side in ("left", "right"):
        yield from ((side, part) for part in anatomy.EYE)
    for side in RIGHT_THEN_LEFT:
        toes = five_finger.TOES[side] if five else mitten.TOES
        yield from ((side, part) for part in (*anatomy.LEG, *foot, *toes))


def _motors(five: bool, chest_joint: bool) -> Iterator[tuple[str, MotorFigures]]:
    chest = motors.CHEST_MOTORS if chest_joint else ()
    hand = five_finger.HAND_MOTORS if five else mitten.HAND_MOTORS
    yield from (("", motor) for motor in (*motors.TRUNK_MOTORS, *chest, *motors.HEAD_MOTORS))
    for side in ("left", "right"):
        yield from ((side, motor) for motor in motors.EYE_MOTORS)
    for side in RIGHT_THEN_LEFT:
        yield from ((side, motor) for motor in (*motors.ARM_MOTORS, *hand))
    for side in RIGHT_THEN_LEFT:
        toes = five_finger.TOE_MOTORS[side] if five else mitten.TOE_MOTORS
        yield from ((side, motor) for motor in (*motors.LEG_MOTORS, *toes))


def _with_masses(part: Part, masses_kg: Mapping[str, float]) -> Part:
    geoms = tuple(replace(geom, mass_kg=masses_kg.get(geom.name, geom.mass_kg)) for geom in part.geoms)
    return replace(part, geoms=geoms)

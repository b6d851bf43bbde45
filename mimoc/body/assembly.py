"""Assembly of a complete anatomy from the tables of parts, by law of development."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from mimoc.body import anatomy, five_finger, mitten
from mimoc.body.figures import Development, GeomFigures, MotorFigures, Part
from mimoc.body.motors import CHEST_MOTORS

Sided = tuple[tuple[str, Part], ...]
"""Side (empty for the middle) and part."""

RIGHT_THEN_LEFT = ("right", "left")
LEFT_THEN_RIGHT = ("left", "right")
IN_ORDER_OF_MOTORS = ("trunk", "head", "eyes", "arms", "legs")
"""MIMo lists the motors of the head and the eyes before those of the arms."""

HEAD_MEASURES = ("head_circumference", "head_length", "head_breadth")
"""What the head's shape follows by the law `maturing`."""
HEAD_RULE = (
    "ellipsoid, half as long as head_length and half as broad as head_breadth, both x one factor, such that its level "
    "section has head_circumference; half as high as 1.15 x head_circumference / 2 pi, the crown as high as a round "
    "head's (D)"
)
EYE_RULE = "in the surface of the head"
NECK_RULE = "capsule from the shoulders up into the head, as thick in proportion to the head as MIMo's"
FOOT_RULE = (
    "; higher than MIMo's by the factor at which the average child's foot of that age weighs .062 + .0075 kg x age in "
    "months (mean of Sun & Jensen 1994 and Schneider & Zernicke 1992; M)"
)


@dataclass(frozen=True, eq=False)
class Anatomy:
    """A reference body: everything that does not depend on age."""

    hands: str
    """`mitten` or `five_finger`."""
    development: Development
    """The law of strength, joints and proportions."""
    parts: Sided
    """Side (empty for the midline) and part, parents first, in MIMo's order, by that law."""
    mimos_parts: Sided
    """The same of MIMo's body, whose volumes masses and strength follow by either law."""
    motors: tuple[tuple[str, MotorFigures], ...]
    """Side and motor, in MIMo's order."""
    excluded: tuple[tuple[str, str], ...]
    """Pairs of bodies without contacts."""

    @property
    def geoms(self) -> Mapping[str, GeomFigures]:
        """MIMo's geoms by name with `{side}`."""
        return {geom.name: geom for _, part in self.mimos_parts for geom in part.geoms}

    @property
    def follows(self) -> frozenset[str]:
        """Names of the measurements that this body depends on."""
        of_geoms = ((*geom.follows, *geom.placed_by) for _, part in self.parts for geom in part.geoms)
        return frozenset({name for _, part in self.parts for name in part.follows}.union(*of_geoms))

    @property
    def groups(self) -> Mapping[str, str]:
        """The group that the strength of each joint matures with, by name of the joint."""
        of_part, of_joint = dict[str, str](), dict[str, str]()
        for side, part in self.parts:
            group = part.matures_with or part.group.removeprefix("{side}_")
            group = of_part[part.name.format(side=side)] = group or of_part[(part.parent or "").format(side=side)]
            of_joint |= {joint.name.format(side=side): group for joint in part.joints}
        return of_joint


def assemble(hands: str, chest_joint: bool, development: Development = "maturing") -> Anatomy:
    """Return the anatomy with these hands, and with or without MIMo's two joints of the chest."""
    sections = _sections(hands == "five_finger", chest_joint)
    motors = (
        (side, motor) for section in IN_ORDER_OF_MOTORS for side, part in sections[section] for motor in part.motors
    )
    rooted = five_finger.EXCLUDED if hands == "five_finger" else ()
    excluded = (*anatomy.EXCLUDED, *_on_both_sides(rooted))
    mimos_parts = parts = tuple(_attached_to("", sum(sections.values(), ())))
    if development == "maturing":
        parts, excluded = _maturing(mimos_parts), (*excluded, *_ankles(mimos_parts))
    return Anatomy(hands, development, parts, mimos_parts, tuple(motors), excluded)


def _maturing(parts: Sided) -> Sided:
    """Return MIMo's parts as they are by the law `maturing`.

    The head is an ellipsoid. The neck is a part of the head: published masses of segments count it with the head, and
    the joint between trunk and head, at its lower end, carries both. Feet are higher.
    """
    neck = next(geom for _, part in parts for geom in part.geoms if geom.name == "neck")
    return tuple((side, _maturing_part(part, neck)) for side, part in parts)


def _maturing_part(part: Part, neck: GeomFigures) -> Part:
    if part.lies:
        return replace(part, geoms=tuple(replace(geom, rule=geom.rule + FOOT_RULE) for geom in part.geoms))
    if part.name == "head":
        (head,) = part.geoms
        ellipsoid = replace(head, type="ellipsoid", follows=HEAD_MEASURES, rule=HEAD_RULE)
        return replace(part, geoms=(ellipsoid, replace(neck, rule=NECK_RULE)))
    if part.name == "{side}_eye":
        return replace(part, follows=HEAD_MEASURES, rule=EYE_RULE)
    if neck in part.geoms:
        return replace(part, geoms=tuple(geom for geom in part.geoms if geom is not neck))
    return part


def _ankles(parts: Sided) -> Iterator[tuple[str, str]]:
    """Yield the pairs of bodies that higher feet bring together: the toes of stout newborns are below their shanks."""
    for side, part in parts:
        if part.lies and part.parent == "{side}_foot":
            yield f"{side}_lower_leg", part.name.format(side=side)


def _on_both_sides(pairs: Iterable[tuple[str, str]]) -> Iterator[tuple[str, str]]:
    for side in RIGHT_THEN_LEFT:
        for first, second in pairs:
            yield first.format(side=side), second.format(side=side)


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
    if not five:
        return sections
    return {
        section: tuple((side, _with_masses(part, five_finger.MASSES_KG)) for side, part in parts)
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
    if not any(geom.name in masses_kg for geom in part.geoms):
        return part
    geoms = tuple(replace(geom, mass_kg=masses_kg.get(geom.name, geom.mass_kg)) for geom in part.geoms)
    return replace(part, geoms=geoms)

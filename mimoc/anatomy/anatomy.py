"""Assembly of a complete anatomy from kinds of parts, by law of development."""

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from mimoc.anatomy.part import Development, PartKind, ReferenceGeom, ReferenceMotor, ReferencePart
from mimoc.anatomy.parts import ARM, EYES, FLAT, HEAD, LEG, PARTS, TRUNK, feet_of
from mimoc.anatomy.parts.trunk import CHEST_JOINTS, CHEST_MOTORS, FOLDING, MIMOS_PAIRS
from mimoc.anatomy.published_figures import published_part
from mimoc.base.errors import KindError

Sided = tuple[tuple[str, ReferencePart], ...]  # Side (empty for the middle) and part.

RIGHT_THEN_LEFT = ("right", "left")
IN_ORDER_OF_MOTORS = ("trunk", "head", "eyes", "arms", "legs", "extra")
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
MITTENS_FINGERS = "{side}_fingers1"
GRIP, GRIP_DIMENSIONS = (2.0, 0.02, 0.01), 6
"""Friction of the inside of a mitten's fingers: sliding as of skin on dry surfaces (M), torsional and rolling as of
skin that is pressed flat over one to two centimetres (D); the contacts resist rolling, too. With these, and contacts
that hardly slip, newborns' mittens hold 8 to 24 N by direction, though a mitten wraps nothing: infants hang by
their hands (Robinson 1891, S; fitted, D). If palms or fingertips had such contacts, infants would keep on hands and
knees from birth or from five months on."""
FOOT_RULE = (
    "; higher than MIMo's by the factor at which the average child's foot of that age weighs .062 + .0075 kg x age in "
    "months (mean of Sun & Jensen 1994 and Schneider & Zernicke 1992; M)"
)


@dataclass(frozen=True, eq=False, repr=False)
class Anatomy:
    """A reference body: everything that does not depend on age."""

    hands: str
    extra: tuple[str, ...]  # Kinds of parts that it has besides MIMo's.
    development: Development  # The law of strength, joints and proportions.
    kinds: tuple[PartKind, ...]
    feet: PartKind
    parts: Sided  # Side (empty for the midline) and part, parents first, in MIMo's order, by that law.
    mimos_parts: Sided  # The same of MIMo's body, whose volumes masses and strength follow by either law.
    motors: tuple[tuple[str, ReferenceMotor], ...]  # Side and motor, in MIMo's order.
    excluded: tuple[tuple[str, str], ...]  # Pairs of bodies without contacts.
    frictionless: tuple[tuple[str, str], ...] = ()  # Pairs of geoms that slide on each other.

    def __repr__(self) -> str:
        return f"Anatomy({self.hands!r}, {self.development!r}, extra={self.extra!r})"

    @property
    def childs_parts(self) -> Sided:
        """MIMo's parts without those that no child has."""
        extra = {part.name for name in self.extra for part in PARTS[name].parts}
        return tuple((side, part) for side, part in self.mimos_parts if part.name not in extra)

    @property
    def geoms(self) -> Mapping[str, ReferenceGeom]:
        """MIMo's geoms by name with `{side}`."""
        return {geom.name: geom for _, part in self.mimos_parts for geom in part.geoms}

    def of_foot(self, side: str = "right") -> list[ReferenceGeom]:
        """Return the geoms of a foot with its toes."""
        names = {part.name for part in self.feet.parts}
        return [geom for of_side, part in self.parts if of_side == side and part.name in names for geom in part.geoms]

    @property
    def follows(self) -> frozenset[str]:
        """Names of the measurements that this body depends on."""
        of_geoms = ((*geom.size_from, *geom.position_from) for _, part in self.parts for geom in part.geoms)
        return frozenset({name for _, part in self.parts for name in part.position_from}.union(*of_geoms))

    @property
    def groups(self) -> Mapping[str, str]:
        """The group that the strength of each joint matures with, by name of the joint."""
        of_part, of_joint = dict[str, str](), dict[str, str]()
        for side, part in self.parts:
            group = part.matures_with or part.group.removeprefix("{side}_")
            group = of_part[part.name.format(side=side)] = group or of_part[(part.parent or "").format(side=side)]
            of_joint |= {joint.name.format(side=side): group for joint in part.joints}
        return of_joint


def assemble(
    hands: str, chest_joint: bool, development: Development = "maturing", extra: Sequence[str] = ()
) -> Anatomy:
    """Return the anatomy of an infant with some kind of hands, by a law of development.

    It may have MIMo's two joints of the chest, and *extra* kinds of parts besides MIMo's.

    Raises:
        KindError: If somebody else's parts are on a part that it lacks.
    """
    hand, others, (right_foot, left_foot) = PARTS[hands], tuple(PARTS[name] for name in extra), feet_of(hands)
    trunk = tuple(
        replace(part, joints=CHEST_JOINTS, motors=CHEST_MOTORS) if chest_joint and part.name == "chest" else part
        for part in TRUNK.parts
    )
    arm = (*ARM.parts, *hand.parts)
    legs = {"right": right_foot.parts, "left": left_foot.parts}
    sections: dict[str, Sided] = {
        "trunk": tuple(("", part) for part in trunk),
        "arms": tuple((side, part) for side in RIGHT_THEN_LEFT for part in arm),
        "head": tuple(("", part) for part in HEAD.parts),
        "eyes": tuple((side, part) for side in ("left", "right") for part in EYES.parts),
        "legs": tuple((side, part) for side, foot in legs.items() for part in (*LEG.parts, *foot)),
        "extra": tuple(item for kind in others for item in on_named_sides(kind.parts)),
    }
    kinds = (TRUNK, ARM, hand, HEAD, EYES, LEG, right_foot, *others)
    masses_kg = {name: mass_kg for kind in kinds for name, mass_kg in kind.masses_kg.items()}
    if development == "published":
        masses_kg.pop("ub3", None)  # The published masses of both bodies' shoulder girdles are the same.
        two_toed = right_foot is not FLAT
        for name, sided in sections.items():
            sections[name] = tuple((side, published_part(part, two_toed)) for side, part in sided)
    all_parts = sum(sections.values(), ())
    parts = mimos_parts = _parents_first(all_parts, masses_kg)
    if len(parts) < len(all_parts):
        lost = next(part for _, part in all_parts if part.name not in {part.name for _, part in parts})
        raise KindError(f"'{lost.name}' is on '{lost.parent}', which a body with {hands} hands does not have")
    excluded = [pair for kind in kinds for pair in _excluded(kind)]
    if development == "published":
        excluded.remove(FOLDING)
    else:
        feet = {part.name for part in right_foot.parts}
        parts = _maturing(mimos_parts, feet)
        excluded = [*excluded, *_ankles(right_foot)]
    motors = tuple(
        (side, motor) for section in IN_ORDER_OF_MOTORS for side, part in sections[section] for motor in part.motors
    )
    pairs = tuple(excluded), MIMOS_PAIRS if development == "published" else ()
    return Anatomy(hands, tuple(extra), development, kinds, right_foot, parts, mimos_parts, motors, *pairs)


def _maturing(parts: Sided, feet: Collection[str]) -> Sided:
    """Return MIMo's parts as they are by the law `maturing`.

    The head is an ellipsoid. The neck is a part of the head: published masses of segments count it with the head, and
    the joint between trunk and head, at its lower end, carries both. Feet are higher, and hands hold on.
    Eyes are wet and slide on everything: with friction, a hand or a floor that hits an eye turns it at up to 115 rad/s
    (D). Both little fingers fold into the palm: MIMo's left metacarpal turns about an axis that is not the mirror image
    of the right one's, and moves the knuckle a seventh as far (D).
    """
    neck = next(geom for _, part in parts for geom in part.geoms if geom.name == "neck")
    return tuple((side, _maturing_part(part, neck, feet)) for side, part in parts)


def _maturing_part(part: ReferencePart, neck: ReferenceGeom, feet: Collection[str]) -> ReferencePart:
    if any(geom.name == MITTENS_FINGERS for geom in part.geoms):
        geoms = (
            replace(geom, friction=GRIP, condim=GRIP_DIMENSIONS, grips=True) if geom.name == MITTENS_FINGERS else geom
            for geom in part.geoms
        )
        return replace(part, geoms=tuple(geoms))
    if part.name in feet:
        return replace(part, geoms=tuple(replace(geom, rule=geom.rule + FOOT_RULE) for geom in part.geoms))
    if part.name == "head":
        (head,) = part.geoms
        ellipsoid = replace(head, type="ellipsoid", size_from=HEAD_MEASURES, rule=HEAD_RULE)
        return replace(part, geoms=(ellipsoid, replace(neck, rule=NECK_RULE)))
    if part.name == "{side}_eye":
        geoms = tuple(replace(geom, condim=1, slippery=True) for geom in part.geoms)
        return replace(part, geoms=geoms, position_from=HEAD_MEASURES, rule=EYE_RULE)
    if any(joint.left_axis for joint in part.joints):
        return replace(part, joints=tuple(replace(joint, left_axis=None) for joint in part.joints))
    if neck in part.geoms:
        return replace(part, geoms=tuple(geom for geom in part.geoms if geom is not neck))
    return part


def _ankles(foot: PartKind) -> Iterator[tuple[str, str]]:
    """Yield the pairs of bodies that higher feet bring together: the toes of stout newborns are below their shanks."""
    toes = [part.name for part in foot.parts[1:]]
    for side in RIGHT_THEN_LEFT:
        for name in toes if side == "right" or len(toes) == 1 else reversed(toes):
            yield f"{side}_lower_leg", name.format(side=side)


def _excluded(kind: PartKind) -> Iterator[tuple[str, str]]:
    """Yield the pairs of bodies without contacts, of both sides where their names have `{side}`."""
    for side in RIGHT_THEN_LEFT if any("{side}" in name for pair in kind.excluded for name in pair) else ("",):
        for first, second in kind.excluded:
            yield first.format(side=side), second.format(side=side)


def on_named_sides(parts: Iterable[ReferencePart]) -> Iterator[tuple[str, ReferencePart]]:
    """Yield parts on both sides if their names have `{side}`, and in the middle otherwise."""
    for part in parts:
        for side in RIGHT_THEN_LEFT if "{side}" in part.name else ("",):
            yield side, part


def _parents_first(parts: Sided, masses_kg: Mapping[str, float]) -> Sided:
    """Return the parts, each followed by all on it: MuJoCo numbers bodies and joints like that."""
    attached: dict[str, list[tuple[str, ReferencePart]]] = {}
    for side, part in parts:
        attached.setdefault((part.parent or "").format(side=side), []).append((side, part))

    def below(parent: str) -> Iterator[tuple[str, ReferencePart]]:
        for side, part in attached.get(parent, ()):
            yield side, _with_masses(part, masses_kg)
            yield from below(part.name.format(side=side))

    return tuple(below(""))


def _with_masses(part: ReferencePart, masses_kg: Mapping[str, float]) -> ReferencePart:
    if not any(geom.name in masses_kg for geom in part.geoms):
        return part
    geoms = tuple(replace(geom, mass_kg=masses_kg.get(geom.name, geom.mass_kg)) for geom in part.geoms)
    return replace(part, geoms=geoms)

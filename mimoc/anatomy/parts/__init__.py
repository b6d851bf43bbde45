"""The parts that bodies are assembled from: MIMo's, and others' by the entry points `mimoc.parts`."""

from collections import Counter
from collections.abc import Collection, Iterator, Sequence

from mimoc.anatomy.part import MATURING_GROUPS, BodyGeometry, PartKind, ReferencePart
from mimoc.anatomy.parts import hands, head, trunk
from mimoc.anatomy.parts.limbs import ARM, FLAT, LEFT_TWO_TOED, LEG, RIGHT_TWO_TOED
from mimoc.base.errors import KindError, suggestion
from mimoc.base.kinds import Registry

PARTS = Registry(PartKind, "body part", (hands.MITTEN, hands.FIVE_FINGER))  # What a spec can choose or add.

TRUNK, HEAD, EYES = trunk.KIND, head.KIND, head.EYES


def kinds_of_hands() -> tuple[str, ...]:
    """Return the hands that an infant can have, MIMo's first."""
    return tuple(name for name, kind in PARTS.items() if kind.replaces == "hands")


def extra_kinds() -> tuple[str, ...]:
    """Return the parts that an infant can have besides MIMo's."""
    return tuple(name for name, kind in PARTS.items() if kind.replaces is None)


def feet_of(kind: str) -> tuple[PartKind, PartKind]:
    """Return the right and the left foot of an infant with hands of some kind."""
    return (RIGHT_TWO_TOED, LEFT_TWO_TOED) if kind == hands.FIVE_FINGER.name else (FLAT, FLAT)


def check_parts(kind: PartKind) -> None:
    """Raise a KindError with the first reason why a kind's parts do not fit together or onto MIMo's body."""
    if problem := next(_problems(kind), None):
        raise KindError(f"the body part '{kind.name}' does not fit: {problem}")


def check_dimensions(kind: PartKind, dimensions: BodyGeometry) -> None:
    """Raise a KindError unless the shape of a kind places all its parts, with a shape for each of their geoms."""
    for part in kind.parts:
        missing = [geom.name for geom in part.geoms if geom.name not in dimensions.shapes]
        if part.name not in dimensions.origins or missing:
            needed = f"size and place of the geom '{missing[0]}'" if missing else f"the place of '{part.name}'"
            raise KindError(f"the shape of the body part '{kind.name}' does not say {needed}")


def _problems(kind: PartKind) -> Iterator[str]:
    if not kind.parts:
        yield "it has no parts"
    other_hands = [] if kind.replaces else [other for other in PARTS.values() if other.replaces == "hands"]
    right_foot, _ = feet_of(kind.name)
    usual = (TRUNK, ARM, HEAD, EYES, LEG, right_foot, *other_hands)
    parents = {part.name for other in usual for part in other.parts}
    for part in kind.parts:
        yield from _problems_of_parent(part, parents)
        parents.add(part.name)
        yield from _problems_of_part(part)
    if kind.replaces == "hands" and (kind.parts[0].name, kind.parts[0].parent) != ("{side}_hand", "{side}_lower_arm"):
        yield "hands begin with '{side}_hand', which is on '{side}_lower_arm'"
    yield from _problems_of_names(kind, usual)


def _problems_of_parent(part: ReferencePart, parents: Collection[str]) -> Iterator[str]:
    if part.parent not in parents:
        yield f"'{part.name}' is on '{part.parent}'; {suggestion(str(part.parent), sorted(parents))}"
    if "{side}" in str(part.parent) and "{side}" not in part.name:
        yield f"'{part.name}' is on a part of both sides; write '{{side}}' into its name"


def _problems_of_part(part: ReferencePart) -> Iterator[str]:
    geoms = [geom.name for geom in part.geoms]
    joints = [joint.name for joint in part.joints]
    if part.region != "limb":
        yield f"'{part.name}' is of the {part.region}; only limbs can be added"
    if not geoms:
        yield f"'{part.name}' has no geom"
    for item in (*part.geoms, *part.joints, *part.motors):
        if ("{side}" in item.name) != ("{side}" in part.name):
            yield f"'{part.name}' and '{item.name}' are on other sides; write '{{side}}' into both names, or neither"
    for motor in part.motors:
        if motor.joint not in joints:
            yield f"the motor '{motor.name}' moves '{motor.joint}'; {suggestion(motor.joint, joints)}"
        if motor.driven_geom not in geoms:
            yield f"the motor '{motor.name}' follows '{motor.driven_geom}'; {suggestion(motor.driven_geom, geoms)}"
    group = part.matures_with or part.group.removeprefix("{side}_")
    if group and group not in MATURING_GROUPS:
        yield f"the strength of '{part.name}' matures with '{group}'; {suggestion(group, MATURING_GROUPS)}"


def _problems_of_names(kind: PartKind, usual: Sequence[PartKind]) -> Iterator[str]:
    added = (other for other in PARTS.values() if not other.replaces and other.name != kind.name)
    taken = {name for other in (*usual, *added) for part in other.parts for name in _names(part)}
    for name, count in Counter(name for part in kind.parts for name in _names(part)).items():
        if name in taken or count > 1:
            yield f"the name '{name[1]}' is taken; choose another one"


def _names(part: ReferencePart) -> Iterator[tuple[type, str]]:
    """Yield the names in a part, with the type of what has each: a geom may have the name of its part."""
    for item in (part, *part.geoms, *part.joints, *part.motors):
        yield type(item), item.name

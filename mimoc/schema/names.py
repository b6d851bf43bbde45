"""The names a spec can use for measurements, bodies and groups of muscles, and their types."""

from collections.abc import Iterable, Sequence
from typing import Annotated

from pydantic import AfterValidator, Field

from mimoc.anatomy.anatomy import assemble, on_named_sides
from mimoc.anatomy.part import Development as Development
from mimoc.anatomy.parts import HEAD, PARTS, TRUNK, extra_kinds, kinds_of_hands
from mimoc.base.errors import suggestion
from mimoc.schema.quantities import Distinct

SIDES = ("left", "right")

TRUNK_MEASUREMENTS = (
    *("chest_breadth", "chest_circumference", "crown_rump_length", "crown_sole_length", "head_breadth"),
    *("head_circumference", "head_length", "hip_breadth", "hip_circumference", "shoulder_breadth"),
    "waist_circumference",
)
LIMB_MEASUREMENTS = (
    *("ankle_circumference", "calf_circumference", "elbow_hand_length", "foot_breadth", "foot_length"),
    *("forearm_circumference", "hand_breadth", "hand_length", "knee_sole_length", "maximum_fist_breadth"),
    *("mid_thigh_circumference", "middle_finger_diameter", "rump_knee_length", "rump_sole_length"),
    *("shoulder_elbow_length", "thumb_diameter", "upper_arm_circumference"),
)
"""AnthroKids has both sides in one; a spec can tell them apart."""
MEASUREMENTS = tuple(sorted(TRUNK_MEASUREMENTS + LIMB_MEASUREMENTS))

MEASUREMENT_KEYS = tuple(f"{name}_cm" for name in MEASUREMENTS)
SIDED_MEASUREMENT_KEYS = tuple(f"{side}_{name}_cm" for side in SIDES for name in LIMB_MEASUREMENTS)

PAIRED_GROUPS = {f"{limb}s": (f"left_{limb}", f"right_{limb}") for limb in ("arm", "hand", "leg")}
"""The strength groups that mean both sides."""
STRENGTH_GROUPS = (
    *("neck", "trunk", "eyes"),
    *(group for pair in PAIRED_GROUPS.values() for group in pair),
    *PAIRED_GROUPS,
)


def single_groups(names: Iterable[str]) -> set[str]:
    """Return the groups that some names of groups mean, each with its side: `left_arm` and `right_arm` of `arms`."""
    return {single for name in names for single in PAIRED_GROUPS.get(name, (name,))}


def unsided(key: str) -> str:
    """Return the measurement that a key of a spec is of: `foot_length` of `left_foot_length_cm`."""
    return key.removesuffix("_cm").removeprefix("left_").removeprefix("right_")


def trunk_bodies() -> tuple[str, ...]:
    """Return the bodies of trunk and head, which no infant is without."""
    return tuple(part.name for kind in (TRUNK, HEAD) for part in kind.parts)


def limb_bodies(hands: str, extra: Sequence[str] = ()) -> tuple[str, ...]:
    """Return the other bodies of an infant with hands of some kind, and with some kinds of parts besides MIMo's."""
    parts = assemble(hands, False, "published", extra).parts
    return tuple(part.name.format(side=side) for side, part in parts if part.region == "limb")


def bodies_of(kind: str) -> tuple[str, ...]:
    """Return the bodies of a kind of parts."""
    return tuple(part.name.format(side=side) for side, part in on_named_sides(PARTS[kind].parts))


def all_limb_bodies() -> tuple[str, ...]:
    """Return the bodies of all kinds of infants but for trunk and head, sorted."""
    usual = {name for hands in kinds_of_hands() for name in limb_bodies(hands)}
    return tuple(sorted(usual.union(*(bodies_of(kind) for kind in extra_kinds()))))


OTHER_WORDS = {"head": "neck", "body": "trunk", "chest": "trunk", "fingers": "hands", "feet": "legs", "toes": "legs"}
"""Other words for some groups, or for parts of them, which an error translates."""


def _known_group(name: str) -> str:
    if name not in STRENGTH_GROUPS:
        meant = OTHER_WORDS.get(name)
        advice = f"write '{meant}'" if meant else suggestion(name, STRENGTH_GROUPS)
        raise ValueError(f"unknown muscle group; {advice}")
    return name


GroupName = Annotated[str, AfterValidator(_known_group), Field(json_schema_extra={"enum": list(STRENGTH_GROUPS)})]
Groups = Annotated[tuple[GroupName, ...], *Distinct]

"""The names a spec can use for measurements, bodies and groups of muscles."""

from collections.abc import Iterable

from mimoc.body.assembly import assemble
from mimoc.body.figures import Development as Development

SIDES = ("left", "right")

TRUNK_MEASUREMENTS = (
    "chest_breadth",
    "chest_circumference",
    "crown_rump_length",
    "crown_sole_length",
    "head_breadth",
    "head_circumference",
    "head_length",
    "hip_breadth",
    "hip_circumference",
    "shoulder_breadth",
    "waist_circumference",
)
LIMB_MEASUREMENTS = (
    "ankle_circumference",
    "calf_circumference",
    "elbow_hand_length",
    "foot_breadth",
    "foot_length",
    "forearm_circumference",
    "hand_breadth",
    "hand_length",
    "knee_sole_length",
    "maximum_fist_breadth",
    "mid_thigh_circumference",
    "middle_finger_diameter",
    "rump_knee_length",
    "rump_sole_length",
    "shoulder_elbow_length",
    "thumb_diameter",
    "upper_arm_circumference",
)
"""AnthroKids has both sides in one; a spec can tell them apart."""
MEASUREMENTS = tuple(sorted(TRUNK_MEASUREMENTS + LIMB_MEASUREMENTS))

MEASUREMENT_KEYS = tuple(f"{name}_cm" for name in MEASUREMENTS)
SIDED_MEASUREMENT_KEYS = tuple(f"{side}_{name}_cm" for side in SIDES for name in LIMB_MEASUREMENTS)

KINDS_OF_HANDS = ("mitten", "five_finger")

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
    return tuple(part.name for _, part in assemble(KINDS_OF_HANDS[0], False).parts if part.region != "limb")


def limb_bodies(hands: str) -> tuple[str, ...]:
    """Return the other bodies of an infant with hands of some kind."""
    return tuple(part.name.format(side=side) for side, part in assemble(hands, False).parts if part.region == "limb")


def all_limb_bodies() -> tuple[str, ...]:
    """Return the bodies of all kinds of infants but for trunk and head, sorted."""
    return tuple(sorted({name for hands in KINDS_OF_HANDS for name in limb_bodies(hands)}))

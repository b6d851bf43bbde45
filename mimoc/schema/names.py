"""The names a spec can use for measurements, bodies and groups of muscles."""

from collections.abc import Iterable

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

TRUNK_BODIES = ("hip", "lower_body", "upper_body", "chest", "head")
"""What no infant is without."""

_LIMBS = ("eye", "upper_arm", "lower_arm", "hand", "upper_leg", "lower_leg", "foot", "toes")
_FIVE_FINGERS = (
    *("ffknuckle", "ffmiddle", "ffdistal"),
    *("mfknuckle", "mfmiddle", "mfdistal"),
    *("rfknuckle", "rfmiddle", "rfdistal"),
    *("lfmetacarpal", "lfknuckle", "lfmiddle", "lfdistal"),
    *("thbase", "thhub", "thdistal"),
    "big_toe",
)

LIMB_BODIES = {
    "mitten": tuple(f"{side}_{limb}" for side in SIDES for limb in (*_LIMBS, "fingers")),
    "five_finger": tuple(f"{side}_{limb}" for side in SIDES for limb in (*_LIMBS, *_FIVE_FINGERS)),
}
"""The bodies below the trunk, by kind of hands."""
ALL_LIMB_BODIES = tuple(sorted({body for bodies in LIMB_BODIES.values() for body in bodies}))

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

"""The names a spec can use for measurements, bodies, groups of muscles, regions of the body and their joints."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Annotated, TypeVar

from pydantic import AfterValidator, Field

from mimoc.anatomy.anatomy import assemble, on_named_sides
from mimoc.anatomy.part import Development as Development
from mimoc.anatomy.parts import HEAD, PARTS, TRUNK, extra_kinds, kinds_of_hands
from mimoc.base.errors import suggestion
from mimoc.schema.quantities import Distinct

Value = TypeVar("Value")

SIDES = ("left", "right")

ARM, LEG = ("shoulder", "elbow", "wrist", "fingers"), ("hip", "knee", "ankle", "toes")
"""What an arm, with its hand, and a leg, with its foot, can be moved at."""
HAND, FOOT = ARM[2:], LEG[2:]
MIDDLE = ("neck", "trunk", "eyes")
PLURAL = {"foot": "feet", "fingers": "fingers", "toes": "toes"}
"""Plurals that do not end in `s`, and words that mean both sides."""

STEMS: Mapping[str, tuple[str, ...]] = {
    "shoulder": ("shoulder_",),
    "elbow": ("elbow",),
    "wrist": ("hand",),
    "fingers": ("fingers", "ff_", "mf_", "rf_", "lf_", "th_"),
    "hip": ("hip",),
    "knee": ("knee",),
    "ankle": ("foot",),
    "toes": ("toes", "big_toe"),
    "eyes": ("eye_",),
}
"""How the names of the joints of a limb or an eye begin, after their side."""
OF_TRUNK, OF_NECK = ("hip_", "chest_"), ("head_",)  # How the names of joints without a side begin.

BODY = "body"  # The region that is all of the body but the eyes.


def _sided() -> dict[str, tuple[str, ...]]:
    """Return the places of each region of one side, with `{side}`."""
    regions = {place: (place,) for place in (*ARM, *LEG)}
    return {**regions, "arm": ARM, "hand": HAND, "leg": LEG, "foot": FOOT, "side": (*ARM, *LEG)}


def _regions() -> dict[str, frozenset[str]]:
    regions = {place: frozenset({place}) for place in MIDDLE}
    for name, places in _sided().items():
        for side in SIDES:
            regions[f"{side}_{name}"] = frozenset(f"{side}_{place}" for place in places)
        if name != "side":
            both = frozenset(f"{side}_{place}" for side in SIDES for place in places)
            regions[PLURAL.get(name, f"{name}s")] = both
    limbs = frozenset(f"{side}_{place}" for side in SIDES for place in (*ARM, *LEG))
    return {**regions, BODY: limbs | {"neck", "trunk"}}


REGIONS: Mapping[str, frozenset[str]] = _regions()
"""The places of each region: `right_arm` is `right_shoulder`, `right_elbow`, `right_wrist` and `right_fingers`."""


def place_of(joint: str) -> str:
    """Return where a joint is, such as `left_knee` or `trunk`; empty for a joint of a part that no child has.

    Args:
        joint: Its name in the model, such as `robot:left_hip1`.

    Example:
        >>> from mimoc.schema.names import place_of
        >>> place_of("robot:left_hip1"), place_of("robot:hip_bend1"), place_of("robot:right_ff_middle")
        ('left_hip', 'trunk', 'right_fingers')
    """
    name = joint.removeprefix("robot:")
    side, _, rest = name.partition("_")
    if side not in SIDES:
        return "trunk" if name.startswith(OF_TRUNK) else "neck" if name.startswith(OF_NECK) else ""
    for place, stems in STEMS.items():
        if rest.startswith(stems):
            return place if place in MIDDLE else f"{side}_{place}"
    return ""


def of_place(place: str, values: Mapping[str, Value]) -> tuple[str, Value] | None:
    """Return what regions say of a place: the name and the value of the smallest region that it is in, if there is one.

    Args:
        place: As `place_of` returns it; an empty one is in `body` alone.
        values: By region; of those with this place, one is the smallest (`contradiction`).
    """
    regions = [name for name in values if (place in REGIONS[name] if place else name == BODY)]
    if not regions:
        return None
    name = min(regions, key=lambda region: len(REGIONS[region]))
    return name, values[name]


def contradiction(values: Mapping[str, object]) -> tuple[str, str, str] | None:
    """Return two regions that say different things of a place, neither smaller than the other, and the place.

    `right_side` and `legs` do of the right knee, unless something smaller, such as `right_leg`, says what is so there.
    """
    for place in sorted(REGIONS[BODY] | {"eyes"}):
        regions = sorted((len(REGIONS[name]), name) for name in values if place in REGIONS[name])
        if len(regions) > 1 and regions[0][0] == regions[1][0]:
            first, second = regions[0][1], regions[1][1]
            if values[first] != values[second]:
                return first, second, place
    return None


def known_region(name: str) -> str:
    """Return the name of a region; raise a ValueError that names the nearest if there is none of this name."""
    if name not in REGIONS:
        raise ValueError(f"unknown region of the body; {suggestion(name, sorted(REGIONS))}")
    return name


MOVEMENTS: Mapping[str, str] = {
    "shoulder_abduction": "shoulder_ad_ab",
    "shoulder_horizontal": "shoulder_horizontal",
    "shoulder_rotation": "shoulder_rotation",
    "elbow": "elbow",
    "wrist_rotation": "hand1",
    "wrist_flexion": "hand2",
    "wrist_deviation": "hand3",
    "hip_flexion": "hip1",
    "hip_abduction": "hip2",
    "hip_rotation": "hip3",
    "knee": "knee",
    "ankle_flexion": "foot1",
    "ankle_inversion": "foot2",
    "ankle_rotation": "foot3",
}
"""Joints whose range a contracture can limit: as clinicians name their movement, and MIMo's name, after the side."""
NECK_MOVEMENTS = {"neck_rotation": "head_swivel", "neck_flexion": "head_tilt", "neck_side": "head_tilt_side"}


def _joints() -> dict[str, str]:
    sided = {f"{side}_{name}": f"robot:{side}_{joint}" for side in SIDES for name, joint in MOVEMENTS.items()}
    return {**sided, **{name: f"robot:{joint}" for name, joint in NECK_MOVEMENTS.items()}}


RANGED: Mapping[str, str] = _joints()
"""The joint of each movement whose range a contracture can limit: `left_elbow` is `robot:left_elbow`."""


def known_movement(name: str) -> str:
    """Return the name of a movement; raise a ValueError that names the nearest if there is none of this name."""
    if name not in RANGED:
        raise ValueError(f"unknown movement of a joint; {suggestion(name, sorted(RANGED))}")
    return name


def in_regions(values: Mapping[str, Value], joints: Iterable[str]) -> dict[str, tuple[str, Value]]:
    """Return what regions say of some joints, by joint; joints of which nothing is said are left out."""
    said = {joint: of_place(place_of(joint), values) for joint in joints}
    return {joint: item for joint, item in said.items() if item is not None}


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

"""Regions of the body as clinicians name them, and the joints of each: `right_arm`, `legs`, `left_knee`, `trunk`."""

from collections.abc import Iterable, Mapping
from typing import TypeVar

from mimoc.base.errors import suggestion
from mimoc.schema.names import SIDES

Value = TypeVar("Value")

ARM, LEG = ("shoulder", "elbow", "wrist", "fingers"), ("hip", "knee", "ankle", "toes")
"""What an arm, with its hand, and a leg, with its foot, can be moved at."""
HAND, FOOT = ARM[2:], LEG[2:]
MIDDLE = ("neck", "trunk", "eyes")
PLURAL = {"foot": "feet", "fingers": "fingers", "toes": "toes"}
"""Of words to which `s` is not simply added, or that both sides share."""

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
OF_TRUNK, OF_NECK = ("hip_", "chest_"), ("head_",)
"""How the names of joints without a side begin."""

BODY = "body"
"""The region that is all of the body but the eyes."""


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
        >>> from mimoc.schema.regions import place_of
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

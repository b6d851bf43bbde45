"""What the joints of an infant are to general movements: the limbs, and how commands move them."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.runtime.actuation import Actuation, commanded
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.actuation import ActuationEntry

LIMBS = ("right_arm", "left_arm", "right_leg", "left_leg", "trunk", "head")
"""What moves by itself: bursts begin in each of them, or in several at once."""
ARMS, LEGS, TRUNK, IS_LEFT = np.array(
    [[1, 1, 0, 0, 0, 0], [0, 0, 1, 1, 0, 0], [0, 0, 0, 0, 1, 1], [0, 1, 0, 1, 0, 0]], np.float64
)
"""1 for each of `LIMBS` that is an arm, a leg, trunk or head, or on the left; else 0."""
OTHER_SIDE = np.array([0, 0, 2, 2, 4, 5], np.intp)
"""For a limb on the left, the same on the right, as an index in `LIMBS`."""
ARM: Mapping[str, float] = {
    "shoulder_horizontal": 0.8,
    "shoulder_ad_ab": 0.3,
    "shoulder_rotation": 0.0,
    "elbow": -1.0,
    "hand1": 0.0,
    "hand2": -0.5,
    "hand3": 0.0,
    "fingers": -0.7,
}
"""How joints of an arm act together when it bends, above 0 towards positive angles: the hand goes up and inwards."""
LEG: Mapping[str, float] = {
    "hip1": -1.0,
    "hip2": -0.2,
    "hip3": 0.2,
    "knee": -1.0,
    "foot1": 0.7,
    "foot2": 0.0,
    "foot3": 0.0,
    "toes": 0.0,
    "big_toe": 0.0,
}
"""The same of a leg: hip and knee bend and the foot goes up (Thelen & Fisher 1983)."""
SPINE: Mapping[str, float] = {"hip_bend1": 1.0, "hip_lean1": 0.0, "hip_rot1": 0.0}
NECK: Mapping[str, float] = {"head_tilt": 1.0, "head_tilt_side": 0.0, "head_swivel": 0.0}
DISTAL = frozenset({"hand1", "hand2", "hand3", "fingers", "foot1", "foot2", "foot3", "toes", "big_toe"})
WEIGHTS: Mapping[str, float] = {"hip1": 1.25, "knee": 0.62}
"""What bursts ask of a joint relative to others, 1 if it is not named here: so that hips turn by 30 to 60 degrees in a
kick, as has been published (movement of legs is fitted with it)."""
FINGERS = ("ff_", "mf_", "rf_", "lf_", "th_")
"""Prefixes of the joints of five fingers, which are what `fingers` is to mittens."""
POSTURES: Mapping[str, Mapping[str, float]] = {
    "arms_up": {"shoulder_ad_ab": 1.0},
    "arms_bent": {"elbow": -1.0},
    "legs_bent": {"hip1": -1.0},
    "knees_bent": {"knee": -1.0},
    "legs_in": {"hip2": 1.0},
    "legs_out": {"hip3": 1.0},
}
"""The joints of each posture of `Law`."""
GOALS: tuple[Mapping[str, float], ...] = (
    {"shoulder_horizontal": 0.7, "elbow": -0.3, "hip1": -0.8, "knee": 0.2},
    {"shoulder_horizontal": 0.5, "shoulder_ad_ab": 0.3, "elbow": -0.9, "hip1": -0.6, "knee": -0.5},
    {"shoulder_horizontal": 0.5, "shoulder_ad_ab": -0.3, "elbow": 0.3, "hip1": 0.2, "knee": 0.3},
)
"""Where limbs go with a goal, in shares: hands to the midline, the face and the knees; feet up, tucked, and down."""


Roles = Sequence[tuple[str, str, float]]
"""Limb, kind and flexion of hinges."""


@dataclass(frozen=True)
class Joints:
    """The m hinges of an infant that move by themselves, and its n commands."""

    names: tuple[str, ...]
    """Of the hinges, m."""
    limbs: IntArray
    """The limb of each hinge, an index in `LIMBS`, shape (m,)."""
    flexion: FloatArray
    """How it acts when all of its limb bends, shape (m,)."""
    distal: FloatArray
    """1 of wrists, fingers, ankles and toes, else 0, shape (m,)."""
    weights: FloatArray
    """What bursts ask of it relative to other joints, shape (m,)."""
    postures: FloatArray
    """Share of each hinge in the postures of `POSTURES`, shape (postures, m)."""
    goals: FloatArray
    """Its share at each goal, shape (goals, m)."""
    hinges: IntArray
    """The hinge of each command, shape (n,): m for one that is at rest."""
    signs: FloatArray
    """What a share of 1 is in each command, shape (n,): -1 for a muscle that pulls towards negative angles."""
    is_muscle: FloatArray
    """1 of commands that pull one way only, else 0, shape (n,)."""
    low: FloatArray
    high: FloatArray


def joints_of(entry: ActuationEntry, actuation: Actuation) -> Joints:
    """Return the joints that an infant's commands move; its eyes, and parts that children lack, stay at rest."""
    actuators = commanded(entry)
    names = tuple(dict.fromkeys(item.joint for item in actuators if _role(item.joint)))
    roles = [role for name in names if (role := _role(name))]
    pulls = np.sign(actuation.limits_nm).sum(axis=1) * (actuation.low >= 0.0)
    hinges = [names.index(item.joint) if item.joint in names else len(names) for item in actuators]
    return Joints(
        names,
        np.array([LIMBS.index(limb) for limb, _, _ in roles], np.intp),
        np.array([flexion for _, _, flexion in roles], np.float64),
        np.array([part in DISTAL for _, part, _ in roles], np.float64),
        np.array([WEIGHTS.get(part, 1.0) for _, part, _ in roles], np.float64),
        _shares(roles, POSTURES.values()),
        _shares(roles, GOALS),
        np.array(hinges, np.intp),
        np.where(pulls == 0.0, 1.0, pulls),
        np.abs(pulls),
        actuation.low,
        actuation.high,
    )


def _shares(roles: Roles, kinds: Collection[Mapping[str, float]]) -> FloatArray:
    """Return what kinds of posture or goal ask of hinges, shape (kinds, m)."""
    return np.array([[kind.get(part, 0.0) for _, part, _ in roles] for kind in kinds]).reshape(len(kinds), len(roles))


def _role(joint: str) -> tuple[str, str, float] | None:
    """Return limb, kind and flexion of a hinge; None if it does not move by itself."""
    name = joint.rpartition("robot:")[2]  # Before it is the prefix of an infant that shares its world.
    for limb, parts in (("trunk", SPINE), ("head", NECK)):
        if name in parts:
            return limb, name, parts[name]
    side, _, part = name.partition("_")
    if side not in ("left", "right"):
        return None
    if part.startswith(FINGERS):
        part = "fingers"
    for limb, parts in (("arm", ARM), ("leg", LEG)):
        if part in parts:
            return f"{side}_{limb}", part, parts[part]
    return None

"""How infants move by themselves, by age, and how they differ: the numbers of `GeneralMovements`, and their sources."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from mimoc.policies.control.actuators import pulls_of
from mimoc.runtime.actuation import Actuation, commanded
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.actuation import ActuationEntry

AGES_MONTHS = (0.0, 1.0, 2.0, 3.0, 4.0, 6.0, 9.0, 12.0, 24.0)  # Ages of the columns of `COLUMNS`.


@dataclass(frozen=True, slots=True)
class Law:
    """Numbers of spontaneous movement at one age. A share is one of the strength of a joint, in its direction."""

    rate_hz: float  # Bursts a second of a limb, on average.
    strength: float  # Median size of a burst, a share.
    size_spread: float  # Standard deviation of the logarithm of the sizes of bursts.
    duration_s: float  # Median duration of a burst.
    duration_spread: float  # Standard deviation of the logarithm of durations.
    leg_duration: float  # Duration of the bursts of legs, relative to those of others.
    coherence: float
    """Correlation of what a burst asks of the joints of a limb with flexion or extension of all of it, from 0 to 1."""
    rebound: float  # Size of the opposite burst that follows a burst, relative to it.
    together: float  # Share of the bursts that begin in both arms or in both legs at once.
    whole: float  # Share of the bursts that begin in all limbs at once.
    arms_in_phase: float  # Correlation of the directions of such bursts of both arms, from -1 (alternating) to 1.
    legs_in_phase: float  # The same of both legs.
    swell: float  # Standard deviation of the logarithm of the rate of all limbs that arousal makes.
    swell_s: float  # Time constant of arousal.
    size_swell: float  # The same as `swell` of the size of bursts.
    limb_swell: float  # Standard deviation of the logarithm of the rate of a limb by itself.
    limb_swell_s: float  # Its time constant.
    slow: float  # Standard deviation of slow changes of posture, a share.
    slow_s: float  # Their time constant.
    fidget: float  # Standard deviation of the continual small movements, a share.
    fidget_hz: float  # Their frequency.
    tone: float  # Activation of both muscles of all joints, beside everything else.
    arms: float  # Size of the bursts of arms, relative to those of legs.
    trunk: float  # The same of trunk and head.
    distal: float  # The same of wrists, fingers, ankles and toes, relative to their limb.
    arms_up: float  # Posture: share of the muscles that raise the arms.
    arms_bent: float  # Posture: share of the muscles that bend the elbows.
    legs_bent: float  # Posture: share of the muscles that bend the hips.
    knees_bent: float  # Posture: share of the muscles that bend the knees.
    legs_in: float  # Posture: share of the muscles that bring the legs together.
    legs_out: float  # Posture: share of the muscles that turn the legs outwards, so that the feet come together.
    goals: float  # Size of movements towards goals, from 0 to 1.
    goals_hz: float  # Such movements a second of a limb.
    touch: float  # Size of movements of the arms by which hands touch the head, from 0 to 1.
    touch_hz: float  # How often a second an arm goes anew to the head or back.
    touch_share: float  # Probability that it then goes to the head.
    midline: float  # How far the infant keeps its head in the midline, from 0 (it lies where it falls) to 1.


def law_at(age_months: float) -> Law:
    """Return the numbers at an age, linear between the columns of the table, and constant outside them."""
    return Law(**{name: float(np.interp(age_months, AGES_MONTHS, column)) for name, column in COLUMNS.items()})


def _constant(value: float) -> tuple[float, ...]:
    return (value,) * len(AGES_MONTHS)


COLUMNS: Mapping[str, tuple[float, ...]] = {
    "rate_hz": (3.3, 3.4, 3.9, 5.2, 4.6, 4.3, 3.6, 3.2, 3.2),
    "strength": (0.42, 0.44, 0.47, 0.44, 0.39, 0.37, 0.2, 0.14, 0.12),
    "size_spread": _constant(0.65),
    "duration_s": (0.22, 0.22, 0.21, 0.185, 0.185, 0.185, 0.185, 0.185, 0.185),
    "duration_spread": _constant(0.18),
    "leg_duration": _constant(1.15),
    "coherence": (0.96, 0.97, 0.99, 0.7, 0.55, 0.45, 0.4, 0.4, 0.4),
    "rebound": _constant(0.4),
    "together": (0.35, 0.35, 0.45, 0.3, 0.35, 0.65, 0.65, 0.6, 0.6),
    "whole": (0.1, 0.12, 0.2, 0.15, 0.12, 0.1, 0.1, 0.1, 0.1),
    "arms_in_phase": _constant(0.68),
    "legs_in_phase": (-0.85, -0.7, -0.3, 0.26, 0.55, 0.95, 0.95, 0.95, 0.95),
    "swell": (1.1, 1.1, 1.1, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0),
    "swell_s": (5.0, 5.0, 4.0, 2.9, 2.9, 2.9, 2.9, 2.9, 2.9),
    "size_swell": _constant(0.5),
    "limb_swell": _constant(0.44),
    "limb_swell_s": _constant(6.0),
    "slow": (0.16, 0.18, 0.18, 0.13, 0.12, 0.1, 0.08, 0.07, 0.06),
    "slow_s": (2.6, 2.6, 2.6, 2.2, 2.2, 2.2, 2.2, 2.2, 2.2),
    "fidget": (0.0, 0.01, 0.04, 0.09, 0.09, 0.04, 0.02, 0.02, 0.02),
    "fidget_hz": _constant(1.3),
    "tone": _constant(0.03),
    "arms": (1.55, 1.55, 1.55, 1.55, 1.6, 1.8, 2.0, 2.2, 2.2),
    "trunk": _constant(0.5),
    "distal": _constant(0.6),
    "arms_up": _constant(0.08),
    "arms_bent": (-0.2, -0.25, -0.3, -0.4, -0.4, -0.3, -0.2, -0.15, -0.15),
    "legs_bent": (0.15, 0.2, 0.26, 0.26, 0.22, 0.18, 0.12, 0.1, 0.1),
    "knees_bent": _constant(0.09),
    "legs_in": (0.16, 0.16, 0.16, 0.16, 0.14, 0.12, 0.08, 0.06, 0.06),
    "legs_out": (0.24, 0.24, 0.24, 0.24, 0.2, 0.16, 0.1, 0.08, 0.08),
    "goals": (0.0, 0.0, 0.0, 0.0, 0.3, 0.6, 1.0, 1.0, 1.0),
    "goals_hz": _constant(0.3),
    "touch": (0.4, 0.4, 0.4, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    "touch_hz": _constant(0.6),
    "touch_share": _constant(0.2),
    "midline": (0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0),
}
"""Numbers of `Law` at `AGES_MONTHS`.

Those at 3 months are fitted to aggregates of 12 real infants (MINI-RGBD; mean and standard deviation of 21 measures of
movement and of further figures), with muscles. At other ages, directions follow Prechtl 1990, Einspieler & Prechtl
2005, Thelen 1985, Thelen, Ridley-Johnson & Fisher 1983, Piek 1996, Chen 2020 and Lew & Butterworth 1997; `rate_hz`,
`strength` and the postures keep kicks near published rates and excursions. `touch` is fitted to one fact, that hands
touch the head as often as the trunk in the first nine weeks (DiMercurio et al. 2018). `midline` lets the head be in the
midline from three months on, and not before two. Sizes are otherwise ours (docs/general_movements.md).
"""


@dataclass(frozen=True, slots=True)
class Styles:
    """Standard deviations over infants; those without another unit are of the logarithm of a number of `Law`.

    Fitted, with muscles at 3 months, to the standard deviations of the measures of 12 real infants (MINI-RGBD).
    """

    rate: float = 0.25
    strength: float = 0.12
    duration: float = 0.17
    swell: float = 0.25
    slow: float = 0.2
    tone: float = 0.2
    arms: float = 0.2
    side: float = 0.08  # Half the logarithm of the rate of the left limbs over that of the right ones.
    posture: float = 0.12  # Lasting share of each joint itself, not its logarithm.
    limbs: float = 0.1  # Lasting flexion of each limb itself, a share, not its logarithm.


STYLES = Styles()
TRAITS = tuple(field.name for field in fields(Styles) if field.name not in ("posture", "limbs"))
"""What a single number of an infant says; its lasting posture has one for each joint and each limb."""


LIMBS = ("right_arm", "left_arm", "right_leg", "left_leg", "trunk", "head")
"""What moves by itself: bursts begin in each of them, or in several at once."""
ARMS, LEGS, TRUNK, IS_LEFT = np.array(
    [[1, 1, 0, 0, 0, 0], [0, 0, 1, 1, 0, 0], [0, 0, 0, 0, 1, 1], [0, 1, 0, 1, 0, 0]], np.float64
)
"""1 for each of `LIMBS` that is an arm, a leg, trunk or head, or on the left; else 0."""
OTHER_SIDE = np.array([0, 0, 2, 2, 4, 5], np.intp)
"""Index in `LIMBS` of each limb, or of its counterpart on the right if it is on the left."""
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
NECK_REST_RAD: Mapping[str, float] = {"head_tilt": math.radians(5.0)}
"""Angles of the neck at which the head is in the midline; 0 for those that are not named. A choice."""
MIDLINE_PER_RAD, MIDLINE_PER_RAD_S = 2.5, 0.3
"""Share of its strength by which the neck turns back for each radian that the head is away from the midline, and less
for each [rad/s] that it turns so already: a choice, with which infants hold their head from three months on."""
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
TO_HEAD: Mapping[str, float] = {
    "shoulder_horizontal": 0.3,
    "shoulder_ad_ab": 0.6,
    "shoulder_rotation": -0.5,
    "elbow": -0.3,
}
"""How the hand of an infant on its back comes to its head, in shares, as infants touch themselves in their first weeks:
of 240 sets of shares in steps of .3, that with which a hand of one month touches the head most."""


Roles = Sequence[tuple[str, str, float]]  # Limb, kind and flexion of hinges.


@dataclass(frozen=True)
class Joints:
    """The m hinges of an infant that move by themselves, and its n commands."""

    names: tuple[str, ...]  # Names of the m hinges.
    limbs: IntArray  # The limb of each hinge, an index in `LIMBS`, shape (m,).
    flexion: FloatArray  # How it acts when all of its limb bends, shape (m,).
    distal: FloatArray  # 1 of wrists, fingers, ankles and toes, else 0, shape (m,).
    weights: FloatArray  # What bursts ask of it relative to other joints, shape (m,).
    postures: FloatArray  # Share of each hinge in the postures of `POSTURES`, shape (postures, m).
    goals: FloatArray  # Its share at each goal, shape (goals, m).
    to_head: FloatArray  # Its share where the hand goes to the head, shape (m,).
    neck: IntArray
    """Which hinges turn the head, shape (c,), as indices of the m."""
    neck_rest_rad: FloatArray  # Their angles where the head is in the midline, shape (c,).
    hinges: IntArray  # The hinge of each command, shape (n,): m for one that is at rest.
    signs: FloatArray
    """What a share of 1 is in each command, shape (n,): -1 for a muscle that pulls towards negative angles."""
    is_muscle: FloatArray  # 1 of commands that pull one way only, else 0, shape (n,).
    low: FloatArray
    high: FloatArray


def joints_of(entry: ActuationEntry, actuation: Actuation) -> Joints:
    """Return the joints that an infant's commands move; its eyes, and parts that children lack, stay at rest."""
    actuators = commanded(entry)
    names = tuple(dict.fromkeys(item.joint for item in actuators if _role(item.joint)))
    roles = [role for name in names if (role := _role(name))]
    pulls = pulls_of(actuation)
    neck = [hinge for hinge, (limb, _, _) in enumerate(roles) if limb == "head"]
    hinges = [names.index(item.joint) if item.joint in names else len(names) for item in actuators]
    return Joints(
        names,
        np.array([LIMBS.index(limb) for limb, _, _ in roles], np.intp),
        np.array([flexion for _, _, flexion in roles], np.float64),
        np.array([part in DISTAL for _, part, _ in roles], np.float64),
        np.array([WEIGHTS.get(part, 1.0) for _, part, _ in roles], np.float64),
        _shares(roles, POSTURES.values()),
        _shares(roles, GOALS),
        _shares(roles, [TO_HEAD])[0],
        np.array(neck, np.intp),
        np.array([NECK_REST_RAD.get(roles[hinge][1], 0.0) for hinge in neck], np.float64),
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

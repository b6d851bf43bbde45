"""Small movements of what bears no weight, so that an infant that keeps a posture is never still."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mimoc.policies.behaviours.behaviour import Subject
from mimoc.policies.movement_law import law_at
from mimoc.runtime.sense import FloatArray, IntArray

SIZE_DEG, NEW = 8.0, 0.4
"""Standard deviation of an angle in joints of weight 1, less what friction takes; and what is left of it in a posture
that an infant is just able to keep, as infants are stiff in one that is new to them. A guess."""
RATE = 0.15
"""Movements of a limb a second for each burst a second of general movements (`Law.rate_hz`): about one every 1.5 to 2
seconds. A guess."""
STIRRING, STIRRING_S = 0.35, 0.3
"""Size of the stirring between movements, by theirs, and its time constant. A guess."""
SMOOTHING_S = 0.12
"""Time constant of each of the two low-pass filters behind a movement, which so lasts half a second. A guess."""
LIMBS: Mapping[str, Mapping[str, float]] = {
    "arm": {"shoulder_horizontal": 1.0, "shoulder_ad_ab": 0.8, "shoulder_rotation": 1.0, "elbow": 1.5},
    "hand": {"hand1": 1.0, "hand2": 1.0, "hand3": 0.7, "fingers": 2.0},
    "foot": {"foot1": 1.2, "foot2": 0.7, "foot3": 0.7, "toes": 1.5, "big_toe": 1.5},
    "leg": {"hip3": 0.3, "knee": 0.3},
    "head": {"head_swivel": 2.0, "head_tilt": 0.6, "head_tilt_side": 0.4},
    "trunk": {"hip_rot1": 0.3, "hip_lean1": 0.1, "hip_bend1": 0.1},
}
"""Weights of the joints of each limb, of one side or in the middle: a choice."""
FINGERS = ("ff_", "mf_", "rf_", "lf_", "th_")
"""Prefixes of the joints of five fingers, which move as those of mittens do."""


@dataclass(frozen=True)
class Moving:
    """What moves in a posture, and from which age on how much."""

    limbs: Mapping[str, float]  # Limbs, of `LIMBS`, each with a factor on how far it moves.
    months: tuple[float, float]  # Age at which the posture is new, and from which on it is practised.


class SmallMovements:
    """How far the n driven hinges of an infant are away from their posture now, by movements of its limbs.

    Each limb waits, on average 1 / r seconds, and then goes anywhere about its place in the posture: to an offset x of
    each joint, normal with a standard deviation s w; meanwhile it stirs, by an Ornstein-Uhlenbeck process n of variance
    1. Two low-pass filters make smooth movements of that,

        y' = (x + f s w n - y) / T,    z' = (y - z) / T,

    and z is added to the posture. Rate r (`RATE`) and size s (`SIZE_DEG`, `NEW`) are those of the infant's age, w is
    the weight of the joint, and f is `STIRRING`.
    """

    def __init__(self, subject: Subject, moving: Moving):
        """Find the joints of the limbs that move."""
        names = subject.infant.joint_names
        age_months = subject.manifest.child.corrected_age_months
        self._limb, weights = _limbs_of(names, moving.limbs)
        self._size_rad = math.radians(SIZE_DEG) * float(np.interp(age_months, moving.months, (NEW, 1.0))) * weights
        self._begins = RATE * law_at(age_months).rate_hz * subject.step_s
        self._eases = 1.0 - math.exp(-subject.step_s / SMOOTHING_S)
        self._keeps = math.exp(-subject.step_s / STIRRING_S)
        self.begin()

    def begin(self) -> None:
        """Begin an episode in the posture."""
        nothing = np.zeros_like(self._size_rad)
        self._goal_rad, self._stirring, self._eased_rad, self.offsets_rad = nothing, nothing, nothing, nothing

    def advance(self, generator: np.random.Generator) -> None:
        """Let a control step pass; random numbers are those of the generator."""
        begins = generator.random(int(self._limb.max(initial=0)) + 1) < self._begins
        goal, stir = generator.standard_normal((2, len(self._limb)))
        self._goal_rad = np.where(begins[self._limb], self._size_rad * goal, self._goal_rad)
        self._stirring = self._keeps * self._stirring + math.sqrt(1.0 - self._keeps**2) * stir
        wanted_rad = self._goal_rad + STIRRING * self._size_rad * self._stirring
        self._eased_rad = self._eased_rad + self._eases * (wanted_rad - self._eased_rad)
        self.offsets_rad: FloatArray = self.offsets_rad + self._eases * (self._eased_rad - self.offsets_rad)


def _limbs_of(names: tuple[str, ...], limbs: Mapping[str, float]) -> tuple[IntArray, FloatArray]:
    """Return the number of the limb of each joint, and its weight: 0 for joints that do not move by themselves."""
    found = list[tuple[str, float]]()
    for name in names:
        side, _, part = name.partition("_")
        if side not in ("left", "right"):
            side, part = "", name
        part = "fingers" if part.startswith(FINGERS) else part
        limb = next((limb for limb in limbs if part in LIMBS[limb]), "")
        found.append((f"{side} {limb}", limbs[limb] * LIMBS[limb][part] if limb else 0.0))
    numbers = {limb: number for number, limb in enumerate(dict.fromkeys(limb for limb, _ in found))}
    limb = np.array([numbers[limb] for limb, _ in found], np.intp)
    return limb, np.array([weight for _, weight in found], np.float64)

"""The behaviour that reaches for something with a hand, in submovements that are planned one after the other."""

from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError, check_name
from mimoc.base.units import ms_to_s
from mimoc.bundle.manifest import Manifest
from mimoc.motion.hand_movement import MIN_STEPS, movement_of
from mimoc.policies.behaviours.aiming import LEAD_S, Aim, NoticedTarget, Target, find_target
from mimoc.policies.behaviours.behaviour import (
    SIGHT,
    Behaviour,
    Chance,
    Option,
    Reaction,
    Subject,
    reaction_of,
    read_arguments,
)
from mimoc.policies.control.dynamics import arms_with_hands
from mimoc.policies.control.objectives import directions_across
from mimoc.runtime.sense import FloatArray
from mimoc.schema.names import SIDES

SHORTEST_S = 0.2
"""Duration of a submovement that the hand's top speed does not make longer: units of the reaches of infants of 5 to 9
months last about 200 ms, whatever their length (Fetters & Todd 1987, J Mot Behav 19: 147)."""
AGES_MONTHS = (4.0, 6.0, 9.0, 12.0, 24.0)
SKILLS: Mapping[str, Sequence[float]] = {
    "farthest_m": (0.10, 0.15, 0.20, 0.30, 0.40),
    "direction_deg": (42.0, 29.0, 22.0, 16.0, 8.0),
    "gain": (0.35, 0.25, 0.18, 0.12, 0.06),
    "top_speed_m_s": (0.75, 0.65, 0.55, 0.50, 0.50),
    "elbow": (0.1, 1.0, 1.0, 1.0, 1.0),
}
"""How infants reach, by age. The top speed lies inside what is known of infants, peaks of .3 to .8 m/s, and falls
slowly (Berthier & Keen 2006, Exp Brain Res 169: 507); the elbow is nearly locked at first and used from 6 months
(Thelen et al. 1996). All else is fitted: see docs/behaviours.md."""
PEAK = 1.875  # Peak speed of a minimum-jerk movement by its mean speed.
REACH_PER_S = 5.0  # How fast a hand that is off its path returns to it, or goes to a target by the simple law.
REACH_DAMPING_M = 0.03  # Damping of the inverse kinematics (a choice).
CLOSE_M = 0.015  # Distance from the target below which no further submovement is made (a choice).
ARRIVED_M = 0.03  # How near the palm has to come to a place, which it cannot touch.
STRAIGHT_M_S = 0.4  # Top speed of the simple law, which an option changes (a choice).
"""The word for the simple law, and for a behaviour that reads the state of the simulation."""


@dataclass(frozen=True, slots=True)
class Submovement:
    """A smooth, straight movement of the hand that is not changed once it has begun.

    With s = (t - begin) / T, it is the movement with the least jerk that begins and ends at rest (Flash & Hogan 1985):

        x(t) = x0 + d (10 s³ - 15 s⁴ + 6 s⁵),

    whose speed has its peak of 1.875 |d| / T in the middle.
    """

    begin_s: float
    duration_s: float  # T.
    from_m: FloatArray  # x0, shape (3,).
    way_m: FloatArray  # The displacement d, shape (3,).

    @property
    def end_s(self) -> float:
        """When the hand is to come to rest."""
        return self.begin_s + self.duration_s

    def place_m(self, time_s: float) -> FloatArray:
        """Return where the hand is to be, shape (3,); before and after the movement, where it begins and ends."""
        s = self._phase(time_s)
        return self.from_m + self.way_m * (s**3 * (10 - 15 * s + 6 * s**2))

    def velocity_m_s(self, time_s: float) -> FloatArray:
        """Return how fast the hand is to move, shape (3,)."""
        s = self._phase(time_s)
        return self.way_m * (30 * s**2 * (1 - s) ** 2 / self.duration_s)

    def acceleration_m_s2(self, time_s: float) -> FloatArray:
        """Return how the hand is to accelerate, shape (3,)."""
        s = self._phase(time_s)
        return self.way_m * (60 * s * (1 - s) * (1 - 2 * s) / self.duration_s**2)

    def _phase(self, time_s: float) -> float:
        return min(max((time_s - self.begin_s) / self.duration_s, 0.0), 1.0)


@dataclass(frozen=True)
class Skill:
    """How an infant reaches at its age."""

    farthest_m: float  # How far one submovement leads at most.
    direction_deg: float
    """Standard deviation of the direction of a submovement, in each of the two directions across it."""
    gain: float
    """Standard deviation of the logarithm of the length of a submovement by that which would lead to the target."""
    top_speed_m_s: float  # The hand's speed at its peak; errors of length make it faster or slower.
    elbow: float  # How readily the elbow moves, by the shoulder.

    def plan(
        self, hand_m: FloatArray, target_m: FloatArray, time_s: float, generator: np.random.Generator
    ) -> Submovement:
        """Return the submovement that an infant begins, from where it feels its hand to where it saw the target.

        With the way u m to the target, |u| = 1, and normal numbers a, b, g of the standard deviations `direction_deg`
        and `gain`, the hand goes exp(g) min(m, farthest) far, in the direction of u turned by the angle |(a, b)|
        towards a v + b w, where v and w are perpendicular to u.
        """
        way_m = target_m - hand_m
        distance_m = float(np.linalg.norm(way_m))
        direction = way_m / max(distance_m, 1e-9)
        drawn = generator.standard_normal(3)
        across = np.radians(self.direction_deg) * drawn[:2] @ directions_across(direction)
        angle_rad = float(np.linalg.norm(across))
        turned = np.cos(angle_rad) * direction + np.sinc(angle_rad / np.pi) * across
        length_m = min(distance_m, self.farthest_m)
        duration_s = max(SHORTEST_S, PEAK * length_m / self.top_speed_m_s)
        return Submovement(time_s, duration_s, hand_m.copy(), np.exp(self.gain * drawn[2]) * length_m * turned)


def skill_at(age_months: float) -> Skill:
    """Return how infants of an age reach: between the ages of the table interpolated, beyond them as at the nearest."""
    return Skill(**{name: float(np.interp(age_months, AGES_MONTHS, column)) for name, column in SKILLS.items()})


class Law(Protocol):
    """How a hand is led to a target."""

    def begin(self) -> None:
        """Begin an episode."""
        ...

    def velocity_m_s(
        self, hand_m: FloatArray, target_m: FloatArray, time_s: float, generator: np.random.Generator
    ) -> FloatArray:
        """Return how fast the hand is to move in a control step, shape (3,)."""
        ...


@dataclass
class SubmovementLaw:
    """A sequence of submovements, each planned when the one before has ended.

    With the wanted place x, velocity v and acceleration a in the middle of a control step, and the felt hand h, the
    hand is asked for the velocity

        v + a / (2 w) + k (x - h),

    in which a / (2 w) makes up for the lag of the controller; see `LEAD_S`.
    """

    skill: Skill
    step_s: float  # Duration of a control step.
    current: Submovement | None = None

    def begin(self) -> None:
        """Begin an episode; see `Law`."""
        self.current = None

    def velocity_m_s(
        self, hand_m: FloatArray, target_m: FloatArray, time_s: float, generator: np.random.Generator
    ) -> FloatArray:
        """Return how fast the hand is to move; see `Law`."""
        has_ended = self.current is None or time_s > self.current.end_s - self.step_s / 2
        if has_ended and (self.current is None or float(np.linalg.norm(target_m - hand_m)) > CLOSE_M):
            self.current = self.skill.plan(hand_m, target_m, time_s, generator)
        assert self.current is not None
        middle_s = time_s + self.step_s / 2
        ahead_m_s = LEAD_S / 4 * self.current.acceleration_m_s2(middle_s)
        return self.current.velocity_m_s(middle_s) + ahead_m_s + REACH_PER_S * (self.current.place_m(middle_s) - hand_m)


@dataclass(frozen=True)
class StraightLaw:
    """Straight to the target, as an infant reaches that knows where everything is, and its own hand."""

    speed_m_s: float  # At most.

    def begin(self) -> None:
        """Begin an episode; see `Law`."""

    def velocity_m_s(
        self, hand_m: FloatArray, target_m: FloatArray, time_s: float, generator: np.random.Generator
    ) -> FloatArray:
        """Return how fast the hand is to move; see `Law`."""
        way_m = target_m - hand_m
        return way_m * min(REACH_PER_S, self.speed_m_s / max(float(np.linalg.norm(way_m)), 1e-9))


class SeenTarget(NoticedTarget):
    """A target that is known where it was seen some time ago."""

    def __init__(self, target: Target, reaction: Reaction[int] | None, chance: Chance, late_s: float):
        super().__init__(target, reaction, chance)
        self._late_s = late_s
        self._seen = deque[tuple[float, FloatArray]]()

    def watch(self, data: mujoco.MjData, time_s: float) -> None:
        """See where it is before a control step."""
        super().watch(data, time_s)
        if self._late_s:
            self._seen.append((time_s, self.target.place_m(data).copy()))
            while len(self._seen) > 1 and self._seen[1][0] <= time_s - self._late_s:
                self._seen.popleft()

    def place_m(self, ahead: mujoco.MjData, time_s: float) -> FloatArray | None:
        """Return where it was, shape (3,), as far as the infant has reacted to it; None before the first time."""
        is_known = self._seen and self._is_known(time_s)
        return self._seen[0][1] if is_known else super().place_m(ahead, time_s)


def late_s_of(manifest: Manifest) -> float:
    """Return how long ago an infant has seen what it plans its movements by; 0 without vision."""
    if manifest.senses.vision is None:
        return 0.0
    processing = manifest.delays.processing
    return ms_to_s(dict(manifest.delays)[SIGHT].ms + (processing.reach_ms if processing else 0.0))


@dataclass(frozen=True)
class Arm:
    """An arm that ends in a hand."""

    side: str
    hand: int  # Body of the palm.
    aim: Aim  # Its joints, from the shoulder to the wrist.
    parts: frozenset[int]
    parts_of_hand: frozenset[int]

    def palm_m(self, data: mujoco.MjData) -> FloatArray:
        """Return where its palm is, shape (3,)."""
        return data.xipos[self.hand]


class Reach(Behaviour):
    """Brings the palm of a hand to a target: of several hands, that which is nearest when an episode begins."""

    def __init__(self, subject: Subject, target: Target, arms: Sequence[Arm], law: Law):
        self._model = subject.infant.model
        self._named = target
        self._arms = arms
        self._law = law
        self._subject = subject

    def begin(self, data: mujoco.MjData) -> None:
        """Choose a hand, and of several targets the nearest; see `Behaviour`."""
        targets = [self._named.nearest(data, arm.palm_m(data)) for arm in self._arms]
        ways_m = [target.place_m(data) - arm.palm_m(data) for target, arm in zip(targets, self._arms, strict=True)]
        nearest = int(np.argmin(np.linalg.norm(ways_m, axis=1)))
        self._target, self._arm = targets[nearest], self._arms[nearest]
        self.joints = self._arm.aim.joints
        self.may_touch = self._arm.parts
        self._rest_rad = data.qpos[self._arm.aim.infant.angles[self.joints]].copy()
        self._reached_s, self._closest_m = None, np.inf
        self._path_m = list[FloatArray]()
        manifest, chance = self._subject.manifest, self._subject.chance
        late_s = 0.0 if isinstance(self._law, StraightLaw) else late_s_of(manifest)
        self._noticed = SeenTarget(self._target, reaction_of(manifest, "reach"), chance, late_s)
        self._law.begin()

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angles of the arm; see `Behaviour`."""
        if (place_m := self._noticed.place_m(ahead, time_s)) is None:
            return self._rest_rad
        hand_m = self._arm.palm_m(ahead)
        velocity = self._law.velocity_m_s(hand_m, place_m, time_s, self._subject.chance.drawn_from)
        jacobian = np.empty((3, self._model.nv))
        mujoco.mj_jacBodyCom(self._model, ahead, jacobian, None, self._arm.hand)
        return self._arm.aim.angles(ahead, velocity, jacobian, self._rest_rad)

    def watch(self, data: mujoco.MjData, time_s: float) -> None:
        """Note where the hand is, how near, and when it first touches the target; see `Behaviour`."""
        self._noticed.watch(data, time_s)
        palm_m = self._arm.palm_m(data)
        distance_m = float(np.linalg.norm(self._target.place_m(data) - palm_m))
        self._closest_m = min(self._closest_m, distance_m)
        if self._reached_s is None:
            self._path_m.append(palm_m.copy())
            if self._touches(data, distance_m):
                self._reached_s = time_s

    def metrics(self) -> Mapping[str, float]:
        """Return how near the hand came and, if it touched the target, when and on which path; see `Behaviour`."""
        if self._reached_s is None:
            return {"hand_closest_m": self._closest_m}
        metrics = {"reached_s": self._reached_s, "hand_closest_m": self._closest_m}
        movement = movement_of(np.array(self._path_m), self._subject.step_s)
        if len(movement.path_m) < MIN_STEPS:  # It was there from the beginning.
            return metrics
        return {**metrics, "hand_units": float(movement.units), "hand_path_ratio": movement.path_ratio}

    def _touches(self, data: mujoco.MjData, distance_m: float) -> bool:
        if not self._target.bodies:
            return distance_m < ARRIVED_M
        pairs = self._model.geom_bodyid[data.contact.geom].reshape(-1, 2)
        is_hand = np.isin(pairs, list(self._arm.parts_of_hand))
        return bool((is_hand.any(axis=1) & np.isin(pairs, self._target.bodies).any(axis=1)).any())


def speed_option(default_m_s: float) -> Mapping[str, Option]:
    """Return the option that says how fast the hand moves at most."""
    return {"speed_m_s": Option(default_m_s, 0.05, 1.5)}


def bind_reach(subject: Subject, text: str) -> Reach:
    """Return the behaviour that reaches for what a text names, with the hand of a side or the nearest one.

    Raises:
        PolicyError: If it names nothing, or the infant lacks such a hand.
    """
    skill = skill_at(subject.manifest.child.corrected_age_months)
    knows = subject.reads_truth
    option = speed_option(STRAIGHT_M_S if knows else skill.top_speed_m_s)
    given = read_arguments("reach_for", text, option, most_words=2)
    if not given.words:
        raise PolicyError("'reach_for' needs a target: write reach_for:toy or reach_for:toy,right")
    target = find_target(subject, "reach_for", given.words[0])
    sides = given.words[1:]
    for side in sides:
        check_name("hand that can reach", side, SIDES)
    arms = [arm for arm in _arms(subject, 1.0 if knows else skill.elbow) if not sides or arm.side in sides]
    if not arms:
        raise PolicyError(f"'reach_for' needs a {' '.join([*sides, 'hand'])} that moves, which this infant lacks")
    speed_m_s = given.numbers["speed_m_s"]
    skill = replace(skill, top_speed_m_s=speed_m_s)
    law = StraightLaw(speed_m_s) if knows else SubmovementLaw(skill, subject.step_s)
    return Reach(subject, target, arms, law)


def _arms(subject: Subject, elbow: float) -> Iterator[Arm]:
    infant, model = subject.infant, subject.infant.model
    for limb, hand, between in arms_with_hands(subject.manifest.anatomy, model):
        joints = np.flatnonzero(np.isin(infant.joints, between)).astype(np.intp)
        is_elbow = np.array([infant.joint_names[joint].endswith("elbow") for joint in joints], bool)
        aim = Aim(infant, joints, np.where(is_elbow, elbow, 1.0), REACH_DAMPING_M)
        if joints.size:
            yield Arm(limb.side, hand, aim, subject.bodies_below(limb.root), subject.bodies_below(infant.part(hand)))

"""Reaching for something with one hand."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError, check_name
from mimoc.policies.behaviours.behaviour import Behaviour, Option, Subject, reaction_of, read_arguments
from mimoc.policies.behaviours.look import Aim
from mimoc.policies.behaviours.targets import NoticedTarget, Target, find_target
from mimoc.policies.control.dynamics import joints_between
from mimoc.policies.control.holding.postures import SIDES
from mimoc.runtime.sense import FloatArray

PER_S, DAMPING_M = 5.0, 0.03  # Speed of the hand by its distance, and the damping of its inverse kinematics (a choice).
OPTIONS = {"speed_m_s": Option(0.4, 0.05, 1.5)}
ARRIVED_M = 0.03  # How near the palm has to come to a place, which it cannot touch.


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

    def __init__(self, subject: Subject, target: Target, arms: Sequence[Arm], speed_m_s: float):
        self._model, self._named, self._arms, self._speed_m_s = subject.infant.model, target, arms, speed_m_s
        self._subject = subject

    def begin(self, data: mujoco.MjData) -> None:
        """Choose a hand, and of several targets the nearest; see `Behaviour`."""
        targets = [self._named.nearest(data, arm.palm_m(data)) for arm in self._arms]
        ways_m = [target.place_m(data) - arm.palm_m(data) for target, arm in zip(targets, self._arms, strict=True)]
        nearest = int(np.argmin(np.linalg.norm(ways_m, axis=1)))
        self._target, self._arm = targets[nearest], self._arms[nearest]
        self.joints, self.may_touch = self._arm.aim.joints, self._arm.parts
        self._rest_rad = data.qpos[self._arm.aim.infant.angles[self.joints]].copy()
        self._reached_s, self._closest_m = None, np.inf
        self._noticed = NoticedTarget(self._target, reaction_of(self._subject.manifest, "reach"), self._subject.chance)

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angles of the arm; see `Behaviour`."""
        if (place_m := self._noticed.place_m(ahead, time_s)) is None:
            return self._rest_rad
        way_m = place_m - self._arm.palm_m(ahead)
        jacobian = np.empty((3, self._model.nv))
        mujoco.mj_jacBodyCom(self._model, ahead, jacobian, None, self._arm.hand)
        velocity = way_m * min(PER_S, self._speed_m_s / max(float(np.linalg.norm(way_m)), 1e-9))
        return self._arm.aim.angles(ahead, velocity, jacobian, self._rest_rad)

    def watch(self, data: mujoco.MjData, time_s: float) -> None:
        """Note how near the hand is, and when it first touches the target; see `Behaviour`."""
        self._noticed.watch(data, time_s)
        distance_m = float(np.linalg.norm(self._target.place_m(data) - self._arm.palm_m(data)))
        self._closest_m = min(self._closest_m, distance_m)
        if self._reached_s is None and self._touches(data, distance_m):
            self._reached_s = time_s

    def metrics(self) -> Mapping[str, float]:
        """Return how near the hand came, and the time until it touched the target, if it did; see `Behaviour`."""
        reached = {} if self._reached_s is None else {"reached_s": self._reached_s}
        return {**reached, "hand_closest_m": self._closest_m}

    def _touches(self, data: mujoco.MjData, distance_m: float) -> bool:
        if not self._target.bodies:
            return distance_m < ARRIVED_M
        pairs = self._model.geom_bodyid[data.contact.geom].reshape(-1, 2)
        is_hand = np.isin(pairs, list(self._arm.parts_of_hand))
        return bool((is_hand.any(axis=1) & np.isin(pairs, self._target.bodies).any(axis=1)).any())


def bind(subject: Subject, text: str) -> Reach:
    """Return the behaviour that reaches for what a text names, with the hand of a side or the nearest one.

    Raises:
        PolicyError: If it names nothing, or the infant lacks such a hand.
    """
    given = read_arguments("reach_for", text, OPTIONS, most_words=2)
    if not given.words:
        raise PolicyError("'reach_for' needs a target: write reach_for:toy or reach_for:toy,right")
    target, sides = find_target(subject, "reach_for", given.words[0]), given.words[1:]
    for side in sides:
        check_name("hand that can reach", side, SIDES)
    arms = [arm for arm in _arms(subject) if not sides or arm.side in sides]
    if not arms:
        raise PolicyError(f"'reach_for' needs a {' '.join([*sides, 'hand'])} that moves, which this infant lacks")
    return Reach(subject, target, arms, given.numbers["speed_m_s"])


def _arms(subject: Subject) -> Iterator[Arm]:
    infant, model = subject.infant, subject.infant.model
    for limb in subject.manifest.anatomy.arms:
        if limb.end:
            hand = model.body(limb.end).id
            between = joints_between(model, hand, model.body(limb.root).id)
            joints = np.flatnonzero(np.isin(infant.joints, between)).astype(np.intp)
            aim = Aim(infant, joints, np.ones(len(joints)), DAMPING_M)
            if joints.size:
                yield Arm(limb.side, hand, aim, subject.bodies_below(limb.root), subject.bodies_below(limb.end))

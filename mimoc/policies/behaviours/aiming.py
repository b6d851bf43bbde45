"""Behaviours that aim at something: eyes and head turn to it, or a hand reaches for it."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError, UnknownNameError, check_name
from mimoc.policies.behaviours.behaviour import (
    Behaviour,
    Chance,
    Option,
    Reaction,
    Subject,
    place_of,
    reaction_of,
    read_arguments,
)
from mimoc.policies.control.dynamics import VIEW, arms_with_hands
from mimoc.policies.control.holding import FREQUENCY_RAD_S
from mimoc.policies.control.infant import DrivenInfant
from mimoc.policies.control.objectives import turn_towards
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.names import SIDES

TOY, HEAD = "toy", "_head"
"""The nearest toy, whichever it is; and how the head of another infant is named behind the infant's name."""


@dataclass(frozen=True)
class Target:
    """Something to look at or to reach for."""

    bodies: tuple[int, ...]
    """The bodies that it may be, of which it is the nearest when an episode begins; none for a place."""
    fixed_m: FloatArray  # The place, shape (3,), if it is one.

    def nearest(self, data: mujoco.MjData, from_m: FloatArray) -> "Target":
        """Return the one body of these that is nearest to a place, shape (3,)."""
        if len(self.bodies) < 2:
            return self
        distances_m = [float(np.linalg.norm(data.xipos[body] - from_m)) for body in self.bodies]
        return Target((self.bodies[int(np.argmin(distances_m))],), self.fixed_m)

    def place_m(self, data: mujoco.MjData) -> FloatArray:
        """Return where it is, shape (3,): the centre of mass of a body."""
        return data.xipos[self.bodies[0]] if self.bodies else self.fixed_m


def find_target(subject: Subject, behaviour: str, word: str) -> Target:
    """Return what a word means: `toy`, the name of a toy, an object or any body in the scene, or a place `(x, y, z)`.

    A place is in metres. A part of the infant's own body is named as if it were alone (`head`), one of another infant
    as in the model (`ben_head`); the name of an infant alone (`ben`) means its head. Raises a PolicyError without a toy
    or for a wrong place, and an UnknownNameError.
    """
    if (place := place_of(word)) is not None:
        return Target((), np.array(place))
    model, toys = subject.infant.model, subject.manifest.toys
    if word == TOY and not toys:
        advice = "add scene.toys to its spec, or name another target, such as a part of the body or '(0.3, 0, 0.2)'"
        raise PolicyError(f"'{behaviour}': there is no toy in this scene; {advice}")
    names: dict[str, list[int]] = {TOY: [model.body(toy.body).id for toy in toys]} if toys else {}
    for toy in toys:
        names.setdefault(toy.object, []).append(model.body(toy.body).id)
    for item in subject.manifest.objects:
        names.setdefault(item.name, [model.body(item.body).id])
    for body in np.flatnonzero(subject.infant.is_own).tolist():
        names.setdefault(subject.infant.part(body), [body])
    for body in range(1, model.nbody):
        names.setdefault(model.body(body).name, [body])
    for name in [name for name in names if name.endswith(HEAD)]:
        names.setdefault(name.removesuffix(HEAD), names[name])
    if word not in names:
        raise UnknownNameError(f"target of '{behaviour}' in this scene", word, names)
    return Target(tuple(names[word]), np.zeros(3))


JUMP_M = 0.05
"""Displacement from one control step to the next from which on a target counts as new there; less is followed."""


class NoticedTarget:
    """A target that is new where it appears, and wherever it jumps to."""

    def __init__(self, target: Target, reaction: Reaction[int] | None, chance: Chance):
        self.target, self._reaction, self._chance = target, reaction, chance
        self._number = 0
        self._seen_m: FloatArray | None = None
        self._known_m: FloatArray | None = None
        if reaction:
            reaction.begin()

    def watch(self, data: mujoco.MjData, time_s: float) -> None:
        """See where it is before a control step."""
        place_m = self.target.place_m(data).copy()
        if self._reaction is None:
            return
        is_new = self._seen_m is None or float(np.linalg.norm(place_m - self._seen_m)) > JUMP_M
        if is_new:
            if self._is_known(time_s):
                self._known_m = self._seen_m
            self._number += 1
            self._reaction.see(self._number, time_s, self._chance.drawn_from)
        self._seen_m = place_m

    def place_m(self, ahead: mujoco.MjData, time_s: float) -> FloatArray | None:
        """Return where it is as far as the infant has reacted to it, shape (3,); None before the first time."""
        return self.target.place_m(ahead) if self._is_known(time_s) else self._known_m

    def _is_known(self, time_s: float) -> bool:
        return self._reaction is None or (self._number > 0 and self._reaction.at(time_s) == self._number)


LEAD_S = 2.0 / FREQUENCY_RAD_S
RESTING_PER_S = 1.0  # How fast joints go back to where they rest, as far as the aim leaves them free.
MARGIN_RAD = 0.02  # How far from the ends of their ranges joints stay.


@dataclass(frozen=True)
class Aim:
    """m joints that move a part of the body at a wanted velocity.

    Joint speeds v follow by damped least squares (Nakamura & Hanafusa 1986), v = W Jᵀ (J W Jᵀ + λ² I)⁻¹ x, with the
    wanted velocities x, their Jacobian J and weights W; what leaves x unchanged pulls joints to where they rest. A
    joint goes to

        angle + (2 / w) v,

    by which the spring K = I w² of the controller just makes up for its damper D = 2 I w, so that it turns at speed v.
    """

    infant: DrivenInfant
    joints: IntArray  # Indices among the driven hinges of the infant, shape (m,).
    weights: FloatArray  # How readily each moves, shape (m,).
    damping: float
    """λ, in [m] for places, without a unit for directions: below it, a direction counts as not reachable."""

    def angles(
        self, ahead: mujoco.MjData, velocity: FloatArray, jacobian: FloatArray, rest_rad: FloatArray
    ) -> FloatArray:
        """Return the angles in range, (m,), to go to for a *velocity*, (k,), with a *jacobian*, (k, nv)."""
        infant = self.infant
        now_rad = ahead.qpos[infant.angles[self.joints]]
        by_joint = jacobian[:, infant.dofs[self.joints]]
        weighted = self.weights[:, None] * by_joint.T
        inverse = weighted @ np.linalg.inv(by_joint @ weighted + self.damping**2 * np.eye(len(velocity)))
        resting = RESTING_PER_S * (rest_rad - now_rad)
        speeds = inverse @ velocity + resting - inverse @ (by_joint @ resting)
        low_rad, high_rad = self._range_rad
        return np.minimum(np.maximum(now_rad + LEAD_S * speeds, low_rad), high_rad)

    @cached_property
    def _range_rad(self) -> tuple[FloatArray, FloatArray]:
        low_rad, high_rad = self.infant.model.jnt_range[self.infant.joints[self.joints]].T
        margin_rad = np.minimum(MARGIN_RAD, (high_rad - low_rad) / 4)
        return low_rad + margin_rad, high_rad - margin_rad


GAZE_MUSCLES = ("neck", "eyes")  # Groups of muscles that turn the gaze.
GAZE_PER_S, MAX_GAZE_RAD_S = 8.0, 5.0  # Speed of the gaze by its error, and at most: a choice, slower than saccades.
NECK_WEIGHT, GAZE_DAMPING = 0.05, 0.1
"""How readily the neck turns, by the eyes; and below which the Jacobian counts as zero (a choice)."""


class Look(Behaviour):
    """Turns eyes and head to a target, such that the eyes rest in the middle of their ranges.

    With a vergence v below 1 (`senses.vision.vergence`), an eye at p turns as one at v p + (1 - v) q would, with q
    midway between the eyes: with 0, both are parallel.
    """

    def __init__(self, subject: Subject, target: Target):
        """Bind it to an infant; raise a PolicyError if the infant has no eyes."""
        infant, model = subject.infant, subject.infant.model
        self.joints = subject.moved_by(GAZE_MUSCLES)
        self._cameras = [model.camera(eye.camera).id for eye in subject.manifest.anatomy.eyes]
        if not self._cameras or not self.joints.size:
            raise PolicyError("'look_at' needs eyes and muscles of eyes or neck, which this infant lacks")
        is_eye = np.isin(self.joints, subject.moved_by(("eyes",)))
        self._aim = Aim(infant, self.joints, np.where(is_eye, 1.0, NECK_WEIGHT), GAZE_DAMPING)
        self._model, self._named, self._is_eye, self._subject = model, target, is_eye, subject
        vision = subject.manifest.senses.vision
        self._vergence = 1.0 if vision is None else vision.vergence

    def begin(self, data: mujoco.MjData) -> None:
        """Choose the nearest of several targets; see `Behaviour`."""
        self._target = self._named.nearest(data, np.mean(data.cam_xpos[self._cameras], axis=0))
        self._noticed = NoticedTarget(self._target, reaction_of(self._subject.manifest, "look"), self._subject.chance)
        self._begun_rad = data.qpos[self._aim.infant.angles[self.joints]].copy()
        self._rest_rad = np.where(self._is_eye, 0.0, self._begun_rad)
        self._errors_rad = list[float]()

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angles of eyes and neck; see `Behaviour`."""
        if (place_m := self._noticed.place_m(ahead, time_s)) is None:
            return self._begun_rad
        turns = [self._turn(ahead, camera, place_m, self._vergence) for camera in self._cameras]
        jacobians = [np.empty((3, self._model.nv)) for _ in turns]
        for camera, jacobian in zip(self._cameras, jacobians, strict=True):
            mujoco.mj_jacBody(self._model, ahead, None, jacobian, int(self._model.cam_bodyid[camera]))
        largest = max(float(np.linalg.norm(turn)) for turn in turns)
        per_s = GAZE_PER_S * min(1.0, MAX_GAZE_RAD_S / max(GAZE_PER_S * largest, 1e-9))
        free = ahead.qpos[self._aim.infant.angles[self.joints]]  # The neck stays where it went.
        rest_rad = np.where(self._is_eye, self._rest_rad, free)
        return self._aim.angles(ahead, per_s * np.concatenate(turns), np.concatenate(jacobians), rest_rad)

    def watch(self, data: mujoco.MjData, time_s: float) -> None:
        """Note how far the gaze is from the target; see `Behaviour`."""
        self._noticed.watch(data, time_s)
        turns = [self._turn(data, camera, self._target.place_m(data)) for camera in self._cameras]
        self._errors_rad.append(max(float(np.linalg.norm(turn)) for turn in turns))

    def metrics(self) -> Mapping[str, float]:
        """Return the median error of the worse eye; see `Behaviour`."""
        return {"gaze_error_deg": float(np.degrees(np.median(self._errors_rad)))} if self._errors_rad else {}

    def _turn(self, data: mujoco.MjData, camera: int, place_m: FloatArray, vergence: float = 1.0) -> FloatArray:
        """Return the rotation, shape (3,), [rad], that turns an eye to a place, or as far as it converges."""
        between_m = np.mean(data.cam_xpos[self._cameras], axis=0)
        away_m = place_m - (vergence * data.cam_xpos[camera] + (1 - vergence) * between_m)
        return turn_towards(data.cam_xmat[camera].reshape(3, 3) @ VIEW, away_m / max(np.linalg.norm(away_m), 1e-9))


def bind_look(subject: Subject, text: str) -> Look:
    """Return the behaviour that looks at what a text names; see `find_target`."""
    words = read_arguments("look_at", text, {}, most_words=1).words
    if not words:
        raise PolicyError("'look_at' needs a target: write look_at:toy or look_at:0.3,0,0.2")
    return Look(subject, find_target(subject, "look_at", words[0]))


REACH_PER_S, REACH_DAMPING_M = (
    5.0,
    0.03,
)  # Speed of the hand by its distance, and the damping of its inverse kinematics (a choice).
REACH_OPTIONS = {"speed_m_s": Option(0.4, 0.05, 1.5)}
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
        self._model = subject.infant.model
        self._named = target
        self._arms = arms
        self._speed_m_s = speed_m_s
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
        self._noticed = NoticedTarget(self._target, reaction_of(self._subject.manifest, "reach"), self._subject.chance)

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angles of the arm; see `Behaviour`."""
        if (place_m := self._noticed.place_m(ahead, time_s)) is None:
            return self._rest_rad
        way_m = place_m - self._arm.palm_m(ahead)
        jacobian = np.empty((3, self._model.nv))
        mujoco.mj_jacBodyCom(self._model, ahead, jacobian, None, self._arm.hand)
        velocity = way_m * min(REACH_PER_S, self._speed_m_s / max(float(np.linalg.norm(way_m)), 1e-9))
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


def bind_reach(subject: Subject, text: str) -> Reach:
    """Return the behaviour that reaches for what a text names, with the hand of a side or the nearest one.

    Raises:
        PolicyError: If it names nothing, or the infant lacks such a hand.
    """
    given = read_arguments("reach_for", text, REACH_OPTIONS, most_words=2)
    if not given.words:
        raise PolicyError("'reach_for' needs a target: write reach_for:toy or reach_for:toy,right")
    target = find_target(subject, "reach_for", given.words[0])
    sides = given.words[1:]
    for side in sides:
        check_name("hand that can reach", side, SIDES)
    arms = [arm for arm in _arms(subject) if not sides or arm.side in sides]
    if not arms:
        raise PolicyError(f"'reach_for' needs a {' '.join([*sides, 'hand'])} that moves, which this infant lacks")
    return Reach(subject, target, arms, given.numbers["speed_m_s"])


def _arms(subject: Subject) -> Iterator[Arm]:
    infant, model = subject.infant, subject.infant.model
    for limb, hand, between in arms_with_hands(subject.manifest.anatomy, model):
        joints = np.flatnonzero(np.isin(infant.joints, between)).astype(np.intp)
        aim = Aim(infant, joints, np.ones(len(joints)), REACH_DAMPING_M)
        if joints.size:
            yield Arm(limb.side, hand, aim, subject.bodies_below(limb.root), subject.bodies_below(infant.part(hand)))

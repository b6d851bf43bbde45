"""Looking at something: eyes turn to it, and the head follows."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.policies.behaviours.behaviour import Behaviour, Subject, reaction_of, read_arguments
from mimoc.policies.behaviours.targets import NoticedTarget, Target, find_target
from mimoc.policies.control.dynamics import VIEW
from mimoc.policies.control.holding.controller import FREQUENCY_RAD_S
from mimoc.policies.control.holding.postures import DrivenInfant
from mimoc.policies.control.objectives import turn_towards
from mimoc.runtime.sense import FloatArray, IntArray

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


MOVING = ("neck", "eyes")  # Groups of muscles that turn the gaze.
PER_S, MOST_RAD_S = 8.0, 5.0  # Speed of the gaze by its error, and at most: a choice, slower than saccades.
NECK_WEIGHT, DAMPING = 0.05, 0.1
"""How readily the neck turns, by the eyes; and below which the Jacobian counts as zero (a choice)."""


class Look(Behaviour):
    """Turns eyes and head to a target, such that the eyes rest in the middle of their ranges.

    With a vergence v below 1 (`senses.vision.vergence`), an eye at p turns as one at v p + (1 - v) q would, with q
    midway between the eyes: with 0, both are parallel.
    """

    def __init__(self, subject: Subject, target: Target):
        """Bind it to an infant; raise a PolicyError if the infant has no eyes."""
        infant, model = subject.infant, subject.infant.model
        self.joints = subject.moved_by(MOVING)
        self._cameras = [model.camera(eye.camera).id for eye in subject.manifest.anatomy.eyes]
        if not self._cameras or not self.joints.size:
            raise PolicyError("'look_at' needs eyes and muscles of eyes or neck, which this infant lacks")
        is_eye = np.isin(self.joints, subject.moved_by(("eyes",)))
        self._aim = Aim(infant, self.joints, np.where(is_eye, 1.0, NECK_WEIGHT), DAMPING)
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
        per_s = PER_S * min(1.0, MOST_RAD_S / max(PER_S * largest, 1e-9))
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


def bind(subject: Subject, text: str) -> Look:
    """Return the behaviour that looks at what a text names; see `find_target`."""
    words = read_arguments("look_at", text, {}, most_words=1).words
    if not words:
        raise PolicyError("'look_at' needs a target: write look_at:toy or look_at:0.3,0,0.2")
    return Look(subject, find_target(subject, "look_at", words[0]))

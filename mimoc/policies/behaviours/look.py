"""Looking at something: eyes turn to it, and the head follows."""

from collections.abc import Mapping

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.policies.behaviours.aiming import Aim
from mimoc.policies.behaviours.arguments import read_arguments
from mimoc.policies.behaviours.behaviour import Behaviour, Subject
from mimoc.policies.behaviours.targets import NoticedTarget, Target, find_target
from mimoc.policies.control.frames import VIEW
from mimoc.policies.control.objectives import turn_towards
from mimoc.policies.reaction import reaction_of
from mimoc.runtime.sense import FloatArray

MOVING = ("neck", "eyes")
"""Groups of muscles that turn the gaze."""
PER_S, MOST_RAD_S = 8.0, 5.0
"""Speed of the gaze by its error, and at most: a choice, slower than saccades."""
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

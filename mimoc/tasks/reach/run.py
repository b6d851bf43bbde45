"""Reaching: touch a ball that hangs before the infant."""

from collections.abc import Callable, Sequence
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import ConstraintsEntry
from mimoc.geometry.rotations import direction
from mimoc.model_fields import ModelField
from mimoc.senses.sense import FloatArray
from mimoc.tasks.gaze import Gaze
from mimoc.tasks.reach.spec import ReachEntry
from mimoc.tasks.task import Task, Verdict

STILL_M = 1e-4
"""How far a ball moves before head and eyes follow it."""
MOST_DRAWS = 100
"""How often a place is drawn at most until the ball touches nothing there; of newborns, who have the shortest arms for
their chests, one place in nine is within the infant."""


class ReachTask(Task):
    """A ball before the infant; the reward is the nearer the hand is to it, and more for moving it."""

    def __init__(self, entry: ReachEntry, model: mujoco.MjModel, constraints: ConstraintsEntry):
        """Find everything that *entry* names in *model*."""
        super().__init__(entry.steps)
        self._entry, self._model = entry, model
        self._effector, self._shoulder, self._trunk = (
            model.body(name).id for name in (entry.effector, entry.shoulder, entry.trunk)
        )
        self._ball = model.body(entry.ball.body).id
        self._ball_geom = model.geom(entry.ball.geom).id
        self._ball_at = model.joint(entry.ball.joint).qposadr[0] + np.arange(3)
        self._gaze = Gaze(entry.gaze, model, constraints)
        self._start_m = np.zeros(3)

    @property
    def model_fields(self) -> Sequence[ModelField]:
        """The angles that head and eyes are locked at."""
        return self._gaze.model_fields

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Hang the ball somewhere within reach, clear of everything, and look at it."""
        for _ in range(MOST_DRAWS):
            self._hang(data, self._draw_place(data, generator))
            if not (data.contact.geom == self._ball_geom).any():
                break

    def judge(self, data: mujoco.MjData, action: np.ndarray, effort: Callable[[], float]) -> Verdict:
        """Return what the distance costs, and what a touch earns, which ends the episode."""
        ball_m = data.xpos[self._ball]
        moved_m = float(np.linalg.norm(ball_m - self._start_m))
        if moved_m > STILL_M:
            self._gaze.follow(data, ball_m)
        touched = moved_m > self._entry.moved_m
        distance_m = float(np.linalg.norm(ball_m - data.xpos[self._effector]))
        terms = {"distance": -distance_m, "touch": self._entry.success_reward if touched else 0.0}
        return Verdict(terms, success=touched, terminated=touched)

    @property
    def state(self) -> dict[str, Any]:
        """Where the ball was hung."""
        return {"start_m": self._start_m}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        self._start_m = state["start_m"]

    def _hang(self, data: mujoco.MjData, place_m: FloatArray) -> None:
        """Hang the ball at a place, shape (3,), [m], and turn head and eyes to it."""
        self._start_m = data.qpos[self._ball_at] = place_m
        self._gaze.start(data, place_m)
        mujoco.mj_forward(self._model, data)

    def _draw_place(self, data: mujoco.MjData, generator: np.random.Generator) -> FloatArray:
        """Return a place before the infant, shape (3,), [m]: evenly by distance and angles from the shoulder."""
        entry = self._entry
        ranges = (entry.distance_m, entry.azimuth_rad, entry.elevation_rad)
        distance_m, azimuth, elevation = (generator.uniform(*ends) for ends in ranges)
        trunk = data.xmat[self._trunk].reshape(3, 3)
        return data.xpos[self._shoulder] + trunk @ (distance_m * direction(azimuth, elevation))


def bind(entry: ReachEntry, model: mujoco.MjModel, bundle: Bundle) -> ReachTask:
    """Find what *entry* names in *model*."""
    return ReachTask(entry, model, bundle.manifest.constraints)

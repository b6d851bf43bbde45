"""Reaching: touch a ball that hangs before the infant."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import ConstraintsEntry
from mimoc.geometry.rotations import direction
from mimoc.model_fields import ModelField
from mimoc.mujoco_layout import LOCK_ANGLE
from mimoc.runtime.term import Term
from mimoc.runtime.worlds import Worlds
from mimoc.senses.sense import FloatArray
from mimoc.tasks.gaze import Gaze, bind_gaze
from mimoc.tasks.reach import ReachEntry
from mimoc.tasks.task import Change, Judgement, Task

STILL_M = 1e-4
"""How far a ball that nobody touches may seem to move."""
GAZE_ROUNDS = 12
"""Rounds until the gaze reaches the ball at the start: each reduces the error by more than half."""
MOST_DRAWS = 100
"""How often a place is drawn at most until the ball touches nothing there; of newborns, who have the shortest arms for
their chests, one place in nine is within the infant."""


@dataclass(frozen=True)
class Reach(Term):
    """Distance from hand to ball costs as much as it is, a touch earns a reward and ends the episode.

    The ball is touched when it has moved; head and eyes, which are locked, follow it.
    """

    effector: int
    ball: int
    still_m2: float
    """How far a ball moves before head and eyes follow it, squared, in [m²]."""
    moved_m2: float
    """How far it moves before it counts as touched, squared, in [m²]."""
    success_reward: float
    gaze: Gaze

    def __call__(self, worlds: Worlds, action: Any, memory: Any) -> Judgement:
        """Return the judgement of k infants, whose balls were hung at `start_m`, shape (k, 3), [m]."""
        xp, xpos = worlds.xp, worlds.xpos
        ball_m = xpos[:, self.ball, :]
        moved_m, away_m = ball_m - memory["start_m"], ball_m - xpos[:, self.effector, :]
        moved_m2 = xp.vecdot(moved_m, moved_m)
        is_touched = moved_m2 > self.moved_m2
        terms = {
            "distance": -xp.sqrt(xp.vecdot(away_m, away_m)),
            "touch": xp.where(is_touched, self.success_reward, 0.0),
        }
        turned = Change(moved_m2 > self.still_m2, lambda: self.gaze(worlds, ball_m), LOCK_ANGLE)
        return Judgement(terms, is_touched, is_touched, changes={"eq_data": turned})


class ReachTask(Task):
    """A ball that hangs somewhere within reach."""

    def __init__(self, entry: ReachEntry, model: mujoco.MjModel, constraints: ConstraintsEntry):
        """Find everything that *entry* names in *model*."""
        gaze, self._locks = bind_gaze(entry.gaze, model, constraints)
        bodies = (entry.effector, entry.ball.body, entry.shoulder, entry.trunk)
        effector, ball, self._shoulder, self._trunk = (model.body(name).id for name in bodies)
        term = Reach(effector, ball, STILL_M**2, entry.moved_m**2, entry.success_reward, gaze)
        super().__init__(entry.steps, term, {"start_m": np.zeros(3)})
        self._entry, self._model = entry, model
        self._ball_geom = model.geom(entry.ball.geom).id
        self._ball_at = model.joint(entry.ball.joint).qposadr[0] + np.arange(3)

    @property
    def model_fields(self) -> Sequence[ModelField]:
        """The angles that head and eyes are locked at."""
        return (self._locks,)

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Hang the ball somewhere within reach, clear of everything, and look at it."""
        for _ in range(MOST_DRAWS):
            self._hang(data, self._draw_place(data, generator))
            if not (data.contact.geom == self._ball_geom).any():
                break

    def _hang(self, data: mujoco.MjData, place_m: FloatArray) -> None:
        """Hang the ball at a place, shape (3,), [m], and turn head and eyes to it."""
        self.remember(start_m=place_m)
        data.qpos[self._ball_at] = place_m
        term, worlds = self.term_of_one(data)
        for _ in range(GAZE_ROUNDS):
            data.qpos[term.gaze.angles] = term.gaze(worlds, place_m[None])[0]
            mujoco.mj_kinematics(self._model, data)
        self._model.eq_data[self._locks.rows, LOCK_ANGLE] = data.qpos[term.gaze.angles]
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

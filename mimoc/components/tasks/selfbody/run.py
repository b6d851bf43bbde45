"""Touching oneself: bring a hand to the part of the body that the goal names."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import gymnasium
import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.components.tasks.selfbody import SelfbodyEntry
from mimoc.runtime.sense import IntArray
from mimoc.runtime.task import Judgement, Task
from mimoc.runtime.term import Term
from mimoc.runtime.worlds import Worlds

GOAL = "goal"  # What is remembered and observed: 1 for the part that is to be touched, 0 for all others.
NEITHER = -1  # What a geom is that belongs neither to a target nor to the hand.


@dataclass(frozen=True)
class Selfbody(Term):
    """The reward is large for touching the part that is wanted, which ends the episode.

    It is better the nearer the fingers are to that part while the hand touches another, and a fixed loss for all other
    steps. The touching arm itself and the floor are no parts to be touched.
    """

    fingers: int
    targets: int  # How many parts there are.
    part_of_geom: IntArray
    """The part that each geom belongs to, the number of parts for those of the hand, or `NEITHER`, shape (ngeom,)."""
    geoms: IntArray  # The geoms that belong to parts, shape (g,).
    parts: IntArray  # The parts of these, shape (g,).
    success_reward: float
    idle_reward: float

    def __call__(self, worlds: Worlds, action: Any, memory: Any) -> Judgement:
        """Return the judgement of k infants, whose `goal` is one-hot, shape (k, parts)."""
        xp, is_goal = worlds.xp, memory[GOAL] > 0.5
        is_touched = worlds.pressing(self.part_of_geom)[:, self.targets, : self.targets]
        is_hit = xp.any(is_touched & is_goal, axis=-1)
        is_other = xp.any(is_touched, axis=-1) & ~is_hit
        terms = {
            "touch": xp.where(is_hit, self.success_reward, 0.0),
            "distance": xp.where(is_other, -self._distance_m(worlds, is_goal), 0.0),
            "idle": xp.where(is_hit | is_other, 0.0, self.idle_reward),
        }
        return Judgement(terms, success=is_hit, terminated=is_hit)

    def _distance_m(self, worlds: Worlds, is_goal: Any) -> Any:
        xp = worlds.xp
        offsets_m = xp.take(worlds.geom_xpos, self.geoms, axis=1) - worlds.xpos[:, None, self.fingers, :]
        is_wanted = xp.take(is_goal, self.parts, axis=1)
        return xp.sqrt(xp.min(xp.where(is_wanted, xp.sum(offsets_m * offsets_m, axis=-1), xp.inf), axis=-1))


class SelfbodyTask(Task):
    """A part of the body to be touched, drawn for each episode and observed as one-hot `goal`."""

    def __init__(self, entry: SelfbodyEntry, model: mujoco.MjModel, bundle: Bundle):
        count, parts = len(entry.targets), parts_of_geoms(entry, model)
        geoms = np.flatnonzero((parts >= 0) & (parts < count))
        rewards = entry.success_reward, entry.idle_reward
        term = Selfbody(model.body(entry.fingers).id, count, parts, geoms, parts[geoms], *rewards)
        super().__init__(entry.steps, term, {GOAL: np.zeros(count, np.float32)})
        self._spaces = {GOAL: gymnasium.spaces.Box(0.0, 1.0, (count,), np.float32)}

    @property
    def spaces(self) -> Mapping[str, gymnasium.Space]:
        """The goal: one number for each part that may be wanted."""
        return self._spaces

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Draw the part that is to be touched, each as likely as the others."""
        count = len(self.memory[GOAL])
        self.remember(goal=np.arange(count) == generator.integers(count))


def parts_of_geoms(entry: SelfbodyEntry, model: mujoco.MjModel) -> IntArray:
    """Return for each geom which of n targets it belongs to, n for those that touch, or `NEITHER`, shape (ngeom,).

    What only shows, such as the hair, is neither.
    """
    of_body = np.full(model.nbody, NEITHER)
    of_body[[model.body(name).id for name in entry.effectors]] = len(entry.targets)
    for index, target in enumerate(entry.targets):
        of_body[[model.body(name).id for name in target.bodies]] = index
    solid = (model.geom_contype | model.geom_conaffinity) != 0
    return np.where(solid, of_body[model.geom_bodyid], NEITHER)


bind = SelfbodyTask

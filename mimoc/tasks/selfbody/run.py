"""Touching oneself: bring a hand to the part of the body that the goal names."""

from collections.abc import Callable, Mapping
from typing import Any

import gymnasium
import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.senses.sense import IntArray, Observation
from mimoc.tasks.selfbody.spec import SelfbodyEntry
from mimoc.tasks.task import Task, Verdict

EFFECTOR, NOTHING = -2, -1
"""What a geom is that is no target."""


class SelfbodyTask(Task):
    """A part of the body to be touched, drawn for each episode and observed as one-hot `goal`.

    The reward is large for touching it, better the nearer the fingers are to it while another part is touched, and a
    fixed loss for all other steps. The touching arm itself and the floor are no parts to be touched.
    """

    def __init__(self, entry: SelfbodyEntry, model: mujoco.MjModel):
        """Find everything that *entry* names in *model*."""
        super().__init__(entry.steps)
        self._entry = entry
        self._fingers = model.body(entry.fingers).id
        self._part_of = parts_of_geoms(entry, model)
        self._geoms_of = [np.flatnonzero(self._part_of == index) for index in range(len(entry.targets))]
        self._target = 0

    @property
    def spaces(self) -> Mapping[str, gymnasium.Space]:
        """The goal: one number for each part that may be wanted."""
        return {"goal": gymnasium.spaces.Box(0.0, 1.0, (len(self._geoms_of),), np.float32)}

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Draw the part that is to be touched, each as likely as the others."""
        self._target = int(generator.integers(len(self._geoms_of)))

    def observe(self) -> Observation:
        """Return the goal: 1 for the part that is wanted, 0 for all others."""
        goal = np.zeros(len(self._geoms_of), np.float32)
        goal[self._target] = 1.0
        return {"goal": goal}

    def judge(self, data: mujoco.MjData, action: np.ndarray, effort: Callable[[], float]) -> Verdict:
        """Return what is earned by what the hand touches; touching what is wanted ends the episode."""
        touched = self._touched(data)
        hit = self._target in touched
        terms = {
            "touch": self._entry.success_reward if hit else 0.0,
            "distance": -self._distance_m(data) if touched and not hit else 0.0,
            "idle": 0.0 if touched else self._entry.idle_reward,
        }
        return Verdict(terms, success=hit, terminated=hit)

    @property
    def state(self) -> dict[str, Any]:
        """What is to be touched."""
        return {"target": self._target}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        self._target = state["target"]

    def _touched(self, data: mujoco.MjData) -> set[int]:
        """Return the parts that the hand touches."""
        contact = data.contact
        parts = self._part_of.take(contact.geom)
        of_hand = ((parts == EFFECTOR).any(axis=1)) & (contact.efc_address >= 0)  # Others are near, but do not touch.
        return set(parts[of_hand].max(axis=1).tolist()) - {EFFECTOR, NOTHING}

    def _distance_m(self, data: mujoco.MjData) -> float:
        """Return how far the fingers are from the nearest of the middles of the solids that are wanted."""
        offsets_m = data.geom_xpos[self._geoms_of[self._target]] - data.xpos[self._fingers]
        return float(np.sqrt((offsets_m**2).sum(axis=1).min()))


def parts_of_geoms(entry: SelfbodyEntry, model: mujoco.MjModel) -> IntArray:
    """Return for each geom which of the targets it belongs to, or that it touches, or neither, shape (ngeom,).

    What only shows, such as the hair, is neither.
    """
    of_body = np.full(model.nbody, NOTHING)
    of_body[[model.body(name).id for name in entry.effectors]] = EFFECTOR
    for index, target in enumerate(entry.targets):
        of_body[[model.body(name).id for name in target.bodies]] = index
    solid = (model.geom_contype | model.geom_conaffinity) != 0
    return np.where(solid, of_body[model.geom_bodyid], NOTHING)


def bind(entry: SelfbodyEntry, model: mujoco.MjModel, bundle: Bundle) -> SelfbodyTask:
    """Find what *entry* names in *model*."""
    return SelfbodyTask(entry, model)

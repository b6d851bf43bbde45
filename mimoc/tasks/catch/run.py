"""Catching: hold a ball that falls on the open hand."""

from collections.abc import Callable, Sequence
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.model_fields import ModelField
from mimoc.senses.sense import FloatArray, IntArray
from mimoc.tasks.catch.resizable_ball import ResizableBall
from mimoc.tasks.catch.spec import CatchEntry
from mimoc.tasks.task import Task, Verdict

HAND, BALL = 1, 2
"""What geoms belong to; both together, and nothing else, make the sum of a touch."""


class CatchTask(Task):
    """A ball over the palm; contact is rewarded, effort costs, and the episode ends with the ball held or lost."""

    def __init__(self, entry: CatchEntry, model: mujoco.MjModel):
        """Find everything that *entry* names in *model*, whose ball it changes."""
        super().__init__(entry.steps)
        self._entry, self._model = entry, model
        self._palm, self._palm_m = model.body(entry.palm).id, np.array(entry.palm_m)
        self._ball = ResizableBall(entry.ball, model)
        self._owners = owners_of_geoms(entry, model)
        self._held = 0

    @property
    def model_fields(self) -> Sequence[ModelField]:
        """Size and mass of the ball."""
        return self._ball.model_fields

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Hang a ball of some size and mass at some height over the palm; it falls with the first step."""
        entry, ball = self._entry, self._ball
        radius_m, mass_kg, drop_m = (generator.uniform(*ends) for ends in (entry.radius_m, entry.mass_kg, entry.drop_m))
        ball.change(radius_m, mass_kg)
        x, y, z = self._palm_place(data)
        data.qpos[ball.place] = x, y, z + drop_m + radius_m
        self._held = 0
        mujoco.mj_forward(self._model, data)

    def judge(self, data: mujoco.MjData, action: np.ndarray, effort: Callable[[], float]) -> Verdict:
        """Return what contact earns and effort costs, and what holding or losing the ball does, which ends it."""
        entry = self._entry
        touching = self._touching(data)
        self._held = self._held + 1 if touching else 0
        caught = self._held >= entry.held_steps
        lost = not caught and self._lost(data)
        terms = {
            "contact": entry.contact_reward if touching else 0.0,
            "effort": -entry.effort_weight * effort(),
            "catch": entry.success_reward if caught else 0.0,
            "loss": -entry.success_reward if lost else 0.0,
        }
        return Verdict(terms, success=caught, terminated=caught or lost)

    @property
    def state(self) -> dict[str, Any]:
        """For how many steps the ball has been held."""
        return {"held": self._held}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        self._held = state["held"]

    def _palm_place(self, data: mujoco.MjData) -> FloatArray:
        """Return where the palm is in the world, shape (3,), [m]."""
        return data.xpos[self._palm] + data.xmat[self._palm].reshape(3, 3) @ self._palm_m

    def _touching(self, data: mujoco.MjData) -> bool:
        """Return whether the hand presses on the ball; contacts without a force are near misses."""
        contact = data.contact
        touches = self._owners.take(contact.geom).sum(axis=1) == HAND + BALL
        return bool((contact.efc_address[touches] >= 0).any())

    def _lost(self, data: mujoco.MjData) -> bool:
        """Return whether the ball is well below the palm, or well to its side."""
        x, y, z = data.xpos[self._ball.body] - self._palm_place(data)
        return bool(z < -self._entry.lost_m or np.hypot(x, y) > self._entry.lost_m)


def owners_of_geoms(entry: CatchEntry, model: mujoco.MjModel) -> IntArray:
    """Return for each geom whether it belongs to the hand, is the ball, or neither (0), shape (ngeom,)."""
    owners = HAND * np.isin(model.geom_bodyid, [model.body(name).id for name in entry.hand]).astype(np.intp)
    owners[model.geom(entry.ball.geom).id] = BALL
    return owners


def bind(entry: CatchEntry, model: mujoco.MjModel, bundle: Bundle) -> CatchTask:
    """Find what *entry* names in *model*."""
    return CatchTask(entry, model)

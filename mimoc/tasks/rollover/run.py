"""Turning over: from the back to the belly, or from the belly to the back."""

from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import check_contacts
from mimoc.tasks.rollover.spec import RolloverEntry
from mimoc.tasks.task import SquaredCommands, Task, Verdict
from mimoc.units import to_steps


class RolloverTask(Task):
    """An infant that lies; how far it has turned is the angle between the front of its hip and where that looked.

    That is MIMo's pitch of the hip, -90° on the back and 90° on the belly, as a share of the way from the one to the
    other: 0 is flat on the side that the infant starts on, 1 flat on the other, 0.5 on the flank, on all fours or
    upright. It does not matter which way it turns, and no turn is without a value, as Euler angles are.

    The dense reward is that share, less what the commands cost; success does not end an episode, since it is to be
    kept. The shaped one is sparse, for success, which ends the episode; it is shaped with that share as potential P:
    each step earns discount P(after) - P(before), which changes no best policy (Ng, Harada & Russell 1999), as long
    as an episode that has ended has no potential (Grzes 2017).
    """

    def __init__(self, entry: RolloverEntry, manifest: Manifest, model: mujoco.MjModel):
        """Find everything that *entry* names in *model*."""
        super().__init__(entry.steps)
        self._entry, self._model = entry, model
        self._hip = model.body(entry.hip).id
        self._settling = entry.settle_steps, to_steps(manifest.step_ms, manifest.timestep_ms)
        self._cost = SquaredCommands(manifest.actuation)
        self._starts_on_back = True
        self._turned = 0.0

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Let the infant come to rest, and see which side it is on."""
        steps, substeps = self._settling
        for _ in range(steps):
            mujoco.mj_step(self._model, data, substeps)
            check_contacts(data)
        data.time = 0.0
        mujoco.mj_forward(self._model, data)
        self._starts_on_back = self._pronation(data) < 0.5
        self._turned = self._share(data)

    def judge(self, data: mujoco.MjData, action: np.ndarray, effort: Callable[[], float]) -> Verdict:
        """Return what the turn earns."""
        before, self._turned = self._turned, self._share(data)
        success = self._turned >= self._entry.goal
        if self._entry.reward == "dense":
            cost = self._entry.effort_weight * self._cost(action)
            return Verdict({"turn": self._turned, "effort": -cost}, success=success)
        after = 0.0 if success else self._entry.discount * self._turned
        terms = {"shaping": after - before, "success": self._entry.success_reward if success else 0.0}
        return Verdict(terms, success=success, terminated=success)

    @property
    def state(self) -> dict[str, Any]:
        """Which side it started on, and how far it has turned."""
        return {"starts_on_back": self._starts_on_back, "turned": self._turned}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        self._starts_on_back, self._turned = state["starts_on_back"], state["turned"]

    def _share(self, data: mujoco.MjData) -> float:
        """Return how far the infant has turned, from 0 to 1."""
        pronation = self._pronation(data)
        return pronation if self._starts_on_back else 1.0 - pronation

    def _pronation(self, data: mujoco.MjData) -> float:
        """Return how far the hip is on its belly: 0 is on its back, 1 on its belly."""
        x, y, z = data.xmat[self._hip, ::3]  # Where its front looks.
        return float(np.arctan2(np.hypot(x, y), z) / np.pi)


def bind(entry: RolloverEntry, model: mujoco.MjModel, bundle: Bundle) -> RolloverTask:
    """Find what *entry* names in *model*."""
    return RolloverTask(entry, bundle.manifest, model)

"""Turning over: from the back to the belly, or from the belly to the back."""

from dataclasses import dataclass
from math import pi
from typing import Any

import mujoco
import numpy as np

from mimoc.base.units import to_steps
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import check_contacts
from mimoc.components.tasks.rollover import RolloverEntry
from mimoc.runtime.actuation import command_range
from mimoc.runtime.task import Judgement, SquaredCommands, Task
from mimoc.runtime.term import Term
from mimoc.runtime.worlds import Worlds


@dataclass(frozen=True)
class Rollover(Term):
    """How far an infant has turned is the angle between the front of its hip and where that looked at the start.

    That is MIMo's pitch of the hip, -90° on the back and 90° on the belly, as a share of the way from the one to the
    other: 0 is flat on the side that the infant starts on, 1 flat on the other, 0.5 on the flank, on all fours or
    upright. It does not matter which way it turns, and no turn is without a value, as Euler angles are.

    The dense reward is that share, less what the commands cost; success does not end an episode, since it is to be
    kept. The shaped one is sparse, for success, which ends the episode; it is shaped with that share as potential P:
    each step earns discount P(after) - P(before), which changes no best policy (Ng, Harada & Russell 1999), as long
    as an episode that has ended has no potential (Grzes 2017).
    """

    hip: int
    is_dense: bool
    goal: float
    effort_weight: float
    success_reward: float
    discount: float
    cost: SquaredCommands

    def __call__(self, worlds: Worlds, action: Any, memory: Any) -> Judgement:
        """Return the judgement of k infants, which started on their backs or not, and had turned some way before."""
        xp, pronation = worlds.xp, self.pronation(worlds)
        turned = xp.where(memory["starts_on_back"], pronation, 1.0 - pronation)
        success, remembered = turned >= self.goal, {"turned": turned}
        if self.is_dense:
            effort = -self.effort_weight * self.cost(worlds, action)
            return Judgement({"turn": turned, "effort": effort}, success, memory=remembered)
        after = xp.where(success, 0.0, self.discount * turned)
        reward = xp.where(success, self.success_reward, 0.0)
        return Judgement({"shaping": after - memory["turned"], "success": reward}, success, success, remembered)

    def pronation(self, worlds: Worlds) -> Any:
        """Return how far each hip is turned on its belly, shape (k,): 0 is on its back, 1 on its belly."""
        front, xp = worlds.xmat[:, self.hip, :, 0], worlds.xp
        return xp.atan2(xp.hypot(front[:, 0], front[:, 1]), front[:, 2]) / pi


class RolloverTask(Task):
    """An infant that lies on its back or on its belly, and comes to rest before an episode begins."""

    def __init__(self, entry: RolloverEntry, model: mujoco.MjModel, bundle: Bundle):
        manifest = bundle.manifest
        amounts = entry.goal, entry.effort_weight, entry.success_reward, entry.discount
        cost = SquaredCommands(*command_range(manifest.actuation))
        term = Rollover(model.body(entry.hip).id, entry.reward == "dense", *amounts, cost)
        super().__init__(entry.steps, term, {"starts_on_back": True, "turned": 0.0})
        self._model = model
        self._settling = entry.settle_steps, to_steps(manifest.step_ms, manifest.timestep_ms)

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Let the infant come to rest, and see which side it is on."""
        steps, substeps = self._settling
        for _ in range(steps):
            mujoco.mj_step(self._model, data, substeps)
            check_contacts(data)
        data.time = 0.0
        mujoco.mj_forward(self._model, data)
        term, worlds = self.term_of_one(data)
        pronation = term.pronation(worlds)[0]
        starts_on_back = pronation < 0.5
        self.remember(starts_on_back=starts_on_back, turned=pronation if starts_on_back else 1.0 - pronation)


bind = RolloverTask

"""Muscle actuation: the command is the activation that each muscle goes towards."""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.actuation.commands import Activated, command_range, find_actuators, mean_effort
from mimoc.actuation.spec import ActuationEntry
from mimoc.mujoco_layout import MUSCLE_FORCE, MUSCLE_LENGTHENING, MUSCLE_PASSIVE
from mimoc.senses.sense import FloatArray


@dataclass(frozen=True)
class Muscle(Activated):
    """Commands in [0, 1]; two antagonists a joint, each pulls one way as its activation, length and speed allow."""

    stretched: FloatArray
    """Largest force of each while stretched and active, in isometric forces, shape (n,)."""

    @property
    def bounds_nm(self) -> FloatArray:
        """What no muscle exceeds, even stretched by its antagonist as far as it is active, shape (n,)."""
        return super().bounds_nm * self.stretched

    def effort(self, data: mujoco.MjData) -> float:
        """Return what the activations cost; see `mean_effort`."""
        return mean_effort(data.act[self.activations], np.abs(self.limits_nm).max(axis=1))


def bind(entry: ActuationEntry, model: mujoco.MjModel) -> Muscle:
    """Find the muscles of *entry* in *model*."""
    ids = find_actuators(entry, model)
    pull_nm = -model.actuator_gear[ids, 0] * model.actuator_gainprm[ids, MUSCLE_FORCE]
    limits_nm = np.stack([np.minimum(pull_nm, 0.0), np.maximum(pull_nm, 0.0)], axis=1)
    stretched = model.actuator_gainprm[ids, MUSCLE_PASSIVE] + model.actuator_gainprm[ids, MUSCLE_LENGTHENING]
    return Muscle(ids, *command_range(entry), limits_nm, model.actuator_actadr[ids].astype(np.intp), stretched)

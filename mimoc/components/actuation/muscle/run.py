"""Muscle actuation: commands in [0, 1], the activation that each muscle goes towards.

Two antagonists a joint, each of which pulls one way as its activation, length and speed allow.
"""

import mujoco
import numpy as np

from mimoc.base.mujoco_layout import MUSCLE_FORCE
from mimoc.runtime.actuation import Actuation, activations, command_range, effort_of, find_actuators
from mimoc.schema.actuation import ActuationEntry


def bind(entry: ActuationEntry, model: mujoco.MjModel) -> Actuation:
    """Find the muscles of *entry* in *model*."""
    ids = find_actuators(entry, model)
    pull_nm = -model.actuator_gear[ids, 0] * model.actuator_gainprm[ids, MUSCLE_FORCE]
    limits_nm = np.stack([np.minimum(pull_nm, 0.0), np.maximum(pull_nm, 0.0)], axis=1)
    drive = activations(model, ids)
    return Actuation(ids, *command_range(entry), limits_nm, effort_of(drive, limits_nm), drive, "activation")

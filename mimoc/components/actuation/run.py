"""From commands to controls, for torque motors, muscles and servos."""

import mujoco
import numpy as np

from mimoc.base.mujoco_layout import MUSCLE_FORCE
from mimoc.runtime.actuation import Actuation, activations, command_range, effort_of, find_actuators, limits_of_motors
from mimoc.runtime.term import Field
from mimoc.schema.actuation import ActuationEntry


def bind_torque(entry: ActuationEntry, model: mujoco.MjModel) -> Actuation:
    """Bind motors: torque = gear x command in [-1, 1]; under `maturing`, gear x the activation that follows it."""
    ids = find_actuators(entry, model)
    limits_nm = limits_of_motors(model, ids)
    effort = effort_of(Field("actuator_force", ids), limits_nm)
    if len(ids) and (model.actuator_actadr[ids] >= 0).all():
        drive = activations(model, ids)
        return Actuation(ids, *command_range(entry), limits_nm, effort, drive, "activation")
    return Actuation(ids, *command_range(entry), limits_nm, effort, Field("ctrl", ids), "command")


def bind_muscle(entry: ActuationEntry, model: mujoco.MjModel) -> Actuation:
    """Bind two antagonists for each joint: a command in [0, 1] is the activation that a muscle goes towards.

    Each pulls one way as its activation, length and speed allow.
    """
    ids = find_actuators(entry, model)
    pull_nm = -model.actuator_gear[ids, 0] * model.actuator_gainprm[ids, MUSCLE_FORCE]
    limits_nm = np.stack([np.minimum(pull_nm, 0.0), np.maximum(pull_nm, 0.0)], axis=1)
    drive = activations(model, ids)
    return Actuation(ids, *command_range(entry), limits_nm, effort_of(drive, limits_nm), drive, "activation")


def bind_position(entry: ActuationEntry, model: mujoco.MjModel) -> Actuation:
    """Bind servos: commands in [-1, 1] are the angles they go to, from end to end of the range of each joint."""
    ids = find_actuators(entry, model)
    limits_nm = limits_of_motors(model, ids)
    effort = effort_of(Field("actuator_force", ids), limits_nm, in_newton_metres=True)
    return Actuation(ids, *command_range(entry), limits_nm, effort, Field("ctrl", ids))

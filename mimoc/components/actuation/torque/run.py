"""Torque actuation: commands in [-1, 1]; torque = gear x command, or activation that follows it, within the limits."""

import mujoco

from mimoc.runtime.actuation import Actuation, activations, command_range, effort_of, find_actuators, limits_of_motors
from mimoc.runtime.term import Field
from mimoc.schema.actuation import ActuationEntry


def bind(entry: ActuationEntry, model: mujoco.MjModel) -> Actuation:
    """Find the motors of *entry* in *model*, which have activations under `maturing`."""
    ids = find_actuators(entry, model)
    limits_nm = limits_of_motors(model, ids)
    drive = (
        (activations(model, ids), "activation")
        if (model.actuator_actadr[ids] >= 0).all() and len(ids)
        else (Field("ctrl", ids), "command")
    )
    return Actuation(ids, *command_range(entry), limits_nm, effort_of(Field("actuator_force", ids), limits_nm), *drive)

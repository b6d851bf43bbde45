"""Torque actuation: the command is a share of each motor's gear, at once or through an activation that follows it."""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.actuation.commands import (
    Activated,
    Commands,
    command_range,
    find_actuators,
    limits_of_motors,
    mean_effort,
)
from mimoc.actuation.spec import ActuationEntry


@dataclass(frozen=True)
class Torque(Commands):
    """Commands in [-1, 1]; torque = gear x command, within the motor's force range."""

    def effort(self, data: mujoco.MjData) -> float:
        """Return what the torques of the last physics step cost; see `mean_effort`."""
        return mean_effort(data.actuator_force[self.actuators], np.abs(self.limits_nm).max(axis=1))


@dataclass(frozen=True)
class ActivatedTorque(Activated, Torque):
    """Commands in [-1, 1] that the activations follow; torque = gear x activation, within the motor's force range."""


def bind(entry: ActuationEntry, model: mujoco.MjModel) -> Torque:
    """Find the actuators of *entry* in *model*, which have activations under `maturing`."""
    ids = find_actuators(entry, model)
    torque = Torque(ids, *command_range(entry), limits_of_motors(model, ids))
    if not model.na:
        return torque
    activations = model.actuator_actadr[ids].astype(np.intp)
    return ActivatedTorque(ids, torque.low, torque.high, torque.limits_nm, activations)

"""Position actuation: commands in [-1, 1], the angle that each servo goes to, from end to end of its joint's range."""

import mujoco

from mimoc.runtime.actuation import Actuation, command_range, effort_of, find_actuators, limits_of_motors
from mimoc.runtime.term import Field
from mimoc.schema.actuation import ActuationEntry


def bind(entry: ActuationEntry, model: mujoco.MjModel) -> Actuation:
    """Find the servos of *entry* in *model*."""
    ids = find_actuators(entry, model)
    limits_nm = limits_of_motors(model, ids)
    effort = effort_of(Field("actuator_force", ids), limits_nm, in_newton_metres=True)
    return Actuation(ids, *command_range(entry), limits_nm, effort, Field("ctrl", ids))

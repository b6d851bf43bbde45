"""Actuation: from an action to the controls of the model."""

from typing import Protocol

import mujoco
import numpy.typing as npt

from mimoc.actuation import ACTUATIONS
from mimoc.actuation.spec import ActuationEntry
from mimoc.kinds import function_of
from mimoc.runtime.term import Term
from mimoc.senses.sense import FloatArray, IntArray


class Actuation(Protocol):
    """Converts actions to controls."""

    @property
    def actuators(self) -> IntArray:
        """Index of each actuator in the model, shape (n,)."""
        ...

    @property
    def low(self) -> FloatArray:
        """Smallest command, shape (n,)."""
        ...

    @property
    def high(self) -> FloatArray:
        """Largest command, shape (n,)."""
        ...

    @property
    def limits_nm(self) -> FloatArray:
        """Largest torque of each actuator towards negative and positive angles, shape (n, 2)."""
        ...

    @property
    def drive_name(self) -> str:
        """What `drive` is: `command` or `activation`."""
        ...

    @property
    def bounds_nm(self) -> FloatArray:
        """What the torque of each actuator never exceeds, either way, shape (n,)."""
        ...

    @property
    def drive(self) -> Term:
        """What each actuator is driven by, shape (k, n)."""
        ...

    def __call__(self, action: npt.ArrayLike) -> FloatArray:
        """Return the control of each actuator as a new array, shape (n,)."""
        ...

    def effort(self, data: mujoco.MjData) -> float:
        """Return the present effort of the actuators, a cost."""
        ...


def bind_actuation(entry: ActuationEntry, model: mujoco.MjModel) -> Actuation:
    """Return the conversion of actions to controls for the actuators of *entry* in *model*."""
    return function_of(ACTUATIONS[entry.model].run, "bind")(entry, model)

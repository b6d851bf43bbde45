"""Actuation: from an action to the controls of the model, what drives the actuators then, and what that costs."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.actuation import ACTUATIONS
from mimoc.actuation.spec import ActuationEntry
from mimoc.kinds import function_of
from mimoc.runtime.term import Term, stack_terms
from mimoc.runtime.worlds import worlds_of_one
from mimoc.senses.sense import FloatArray, IntArray


@dataclass(frozen=True)
class Actuation:
    """The n commanded actuators of an infant."""

    actuators: IntArray
    """Index of each actuator in the model, shape (n,)."""
    low: FloatArray
    """Smallest command, shape (n,)."""
    high: FloatArray
    """Largest command, shape (n,)."""
    limits_nm: FloatArray
    """Largest torque about the joint towards negative and positive angles, shape (n, 2)."""
    effort: Term
    """`effort(worlds)` returns the present cost of the actuators, shape (k,); see `mimoc.actuation.commands.Effort`."""
    drive: Term
    """`drive(worlds)` returns what each actuator is driven by now, shape (k, n)."""
    drive_name: str = "command"
    """What `drive` is, such as `activation`."""
    command: Term | None = None
    """`command(worlds, actions)` returns the controls that actions mean, shape (k, n) each; None: they are controls."""

    def controls(self, action: npt.ArrayLike, data: mujoco.MjData) -> FloatArray:
        """Return the control of each actuator as a new array, shape (n,); MuJoCo clips it to its range.

        Raises:
            ValueError: If the action is none of numbers, has the wrong shape, or contains a NaN or an infinity.
        """
        actions, command = self._checked(action), self._alone.command
        return actions if command is None else command(worlds_of_one(data), actions[None])[0]

    def cost(self, data: mujoco.MjData) -> float:
        """Return the present effort of one infant."""
        return float(self._alone.effort(worlds_of_one(data))[0])

    @cached_property
    def _alone(self) -> "Actuation":
        """The same with its terms stacked, for one infant."""
        command = self.command and stack_terms([self.command])
        return replace(self, effort=stack_terms([self.effort]), command=command)

    def _checked(self, action: npt.ArrayLike) -> FloatArray:
        numbers = numbers_of(action)
        if numbers.shape != self.low.shape:
            raise ValueError(f"expected a finite action of shape {self.low.shape}, got shape {numbers.shape}")
        actions = numbers.astype(np.float64)
        if not np.isfinite(actions).all():
            wrong = actions[~np.isfinite(actions)][0]
            raise ValueError(f"expected a finite action of shape {self.low.shape}, got {wrong}")
        return actions


def bind_actuation(entry: ActuationEntry, model: mujoco.MjModel) -> Actuation:
    """Return the commanded actuators of *entry* in *model*."""
    return function_of(ACTUATIONS[entry.model].run, "bind")(entry, model)


def numbers_of(actions: npt.ArrayLike) -> npt.NDArray[Any]:
    """Return what may be one action or several as an array of real numbers.

    Raises:
        ValueError: If it is none.
    """
    try:
        numbers = np.asarray(actions)
    except ValueError:  # Lists of different lengths.
        numbers = np.array(None)
    if numbers.dtype.kind not in "fiub":
        raise ValueError(f"expected an action of numbers, got {actions!r:.60}")
    return numbers

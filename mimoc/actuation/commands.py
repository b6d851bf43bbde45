"""Conversion of an action to controls of MuJoCo's actuators."""

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.actuation.spec import ActuationEntry, ActuatorEntry
from mimoc.runtime.term import Field, Term
from mimoc.senses.sense import FloatArray, IntArray


def numbers(actions: npt.ArrayLike) -> npt.NDArray[Any]:
    """Return what may be one action or several as an array of real numbers.

    Raises:
        ValueError: If it is none.
    """
    try:
        given = np.asarray(actions)
    except ValueError:  # Lists of different lengths.
        given = np.array(None)
    if given.dtype.kind not in "fiub":
        raise ValueError(f"expected an action of numbers, got {actions!r:.60}")
    return given


@dataclass(frozen=True)
class Commands:
    """One command for each of n actuators, used directly as MuJoCo's control, which MuJoCo clips to its range."""

    actuators: IntArray
    """Index of each actuator in the model, shape (n,)."""
    low: FloatArray
    """Smallest command, shape (n,)."""
    high: FloatArray
    """Largest command, shape (n,)."""
    limits_nm: FloatArray
    """Largest torque about the joint towards negative and positive angles, shape (n, 2)."""

    def __call__(self, action: npt.ArrayLike) -> FloatArray:
        """Return the control of each actuator as a new array, shape (n,).

        Raises:
            ValueError: If the action is none of numbers, has the wrong shape, or contains a NaN or an infinity.
        """
        given = numbers(action)
        if given.shape != self.low.shape:
            raise ValueError(f"expected a finite action of shape {self.low.shape}, got shape {given.shape}")
        controls = given.astype(np.float64)
        if not np.isfinite(controls).all():
            wrong = controls[~np.isfinite(controls)][0]
            raise ValueError(f"expected a finite action of shape {self.low.shape}, got {wrong}")
        return controls

    @property
    def drive_name(self) -> str:
        """What `drive` is: `command` or `activation`."""
        return "command"

    @property
    def drive(self) -> Term:
        """What each actuator is driven by, shape (k, n)."""
        return Field("ctrl", self.actuators)

    @property
    def bounds_nm(self) -> FloatArray:
        """What the torque of each actuator never exceeds, either way, shape (n,)."""
        return np.abs(self.limits_nm).max(axis=1)


@dataclass(frozen=True)
class Activated(Commands):
    """Commands that the activations of n actuators follow; these drive the actuators."""

    activations: IntArray
    """Index of each actuator's activation in the state, shape (n,)."""

    @property
    def drive_name(self) -> str:
        """What `drive` is."""
        return "activation"

    @property
    def drive(self) -> Term:
        """The activation of each actuator, shape (k, n)."""
        return Field("act", self.activations)


def all_commanded(entry: ActuationEntry) -> ActuationEntry:
    """Return the actuators with all of them commanded, as strength does not depend on which ones are."""
    if all(actuator.commanded for actuator in entry.actuators):
        return entry
    actuators = tuple(actuator.model_copy(update={"commanded": True}) for actuator in entry.actuators)
    return entry.model_copy(update={"actuators": actuators})


def commanded(entry: ActuationEntry) -> list[ActuatorEntry]:
    """Return the commanded actuators, in the order of the action."""
    return [actuator for actuator in entry.actuators if actuator.commanded]


def find_actuators(entry: ActuationEntry, model: mujoco.MjModel) -> IntArray:
    """Return the index in *model* of each commanded actuator, shape (n,)."""
    return np.array([model.actuator(actuator.name).id for actuator in commanded(entry)], dtype=np.intp)


def command_range(entry: ActuationEntry) -> tuple[FloatArray, FloatArray]:
    """Return the smallest and the largest commands, shape (n,) each."""
    low = np.array([actuator.action_low for actuator in commanded(entry)])
    return low, np.array([actuator.action_high for actuator in commanded(entry)])


def limits_of_motors(model: mujoco.MjModel, ids: IntArray) -> FloatArray:
    """Return the largest torque of n motors towards negative and positive angles, shape (n, 2), in [N m]."""
    return model.actuator_gear[ids, :1] * model.actuator_forcerange[ids]


def mean_effort(shares: FloatArray, torques_nm: FloatArray) -> float:
    """Return the sum of u² T divided by n times the sum of T (MIMo), between 0 and 1 / n; 0 if all T are zero.

    Args:
        shares: Fraction u of its strength that each actuator uses, shape (n,).
        torques_nm: Largest torque T of each actuator, shape (n,).
    """
    strength_nm = len(shares) * torques_nm.sum()
    return float(shares**2 @ torques_nm / strength_nm) if strength_nm else 0.0

"""What actuation models are made of: the actuators that take commands, their limits, and terms for what they cost."""

from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.actuation.spec import ActuationEntry, ActuatorEntry
from mimoc.runtime.term import Field, Term
from mimoc.runtime.worlds import Worlds
from mimoc.senses.sense import FloatArray, IntArray


@dataclass(frozen=True)
class Effort(Term):
    """Effort E = Σ u² T / (n Σ T) of n actuators (MIMo), with the largest torque T of each and its share u in use.

    E is between 0 and 1 / n, and 0 if all T are zero; shape (k,).
    """

    used: Term
    """Measures what is in use of each actuator, shape (k, n)."""
    full: FloatArray
    """What it measures of an actuator that uses all of its strength, shape (n,)."""
    torques_nm: FloatArray
    """T, shape (n,)."""
    strength_nm: float
    """n Σ T, or 1 if that is zero."""

    def __call__(self, worlds: Worlds) -> Any:
        """Return what they cost now."""
        return worlds.xp.vecdot((self.used(worlds) / self.full) ** 2, self.torques_nm) / self.strength_nm


def effort_of(used: Term, limits_nm: FloatArray, in_newton_metres: bool = False) -> Effort:
    """Return what n actuators cost.

    Args:
        used: Measures what is in use of each, shape (k, n).
        limits_nm: Largest torque of each towards negative and positive angles, shape (n, 2).
        in_newton_metres: Whether *used* measures torques, and not shares of the largest one.
    """
    torques_nm = np.abs(limits_nm).max(axis=1)
    full = np.where(torques_nm > 0, torques_nm, np.inf) if in_newton_metres else np.ones(len(torques_nm))
    return Effort(used, full, torques_nm, float(len(torques_nm) * torques_nm.sum()) or 1.0)


def activations(model: mujoco.MjModel, ids: IntArray) -> Field:
    """Return a term for the activations of n actuators, shape (k, n)."""
    return Field("act", model.actuator_actadr[ids].astype(np.intp))


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

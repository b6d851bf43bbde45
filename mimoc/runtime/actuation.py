"""Actuation: from an action to the controls of the model, what drives the actuators then, and what that costs.

Actuation models are made of the terms and the functions of this module.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.classes import PATH, takes
from mimoc.base.kinds import function_of
from mimoc.bundle.io import Bundle, read_bundle
from mimoc.bundle.model import load_model
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.runtime.term import Field, Term, stack_terms
from mimoc.runtime.worlds import Worlds, worlds_of_one
from mimoc.schema.actuation import ActuationEntry, ActuatorEntry
from mimoc.schema.kinds import ACTUATIONS


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
    """`effort(worlds)` returns the present cost of the actuators, shape (k,); see `mimoc.runtime.actuation.Effort`."""
    drive: Term
    """`drive(worlds)` returns what each actuator is driven by now, shape (k, n)."""
    drive_name: str = "command"
    """What `drive` is, such as `activation`."""
    bandwidth_hz: float | None = None
    """Cut-off of each of the two low-pass filters that commands pass; None for no limit."""
    command: Term | None = None
    """`command(worlds, actions)` returns the controls that actions mean, shape (k, n) each; None: they are controls."""

    def controls(self, action: npt.ArrayLike, data: mujoco.MjData) -> FloatArray:
        """Return the control of each actuator as a new array, shape (n,); MuJoCo clips it to its range.

        Raises:
            ValueError: If the action is none of numbers, has the wrong shape, or contains a NaN or an infinity.
        """
        numbers = numbers_of(action)
        if numbers.shape != self.low.shape:
            raise ValueError(f"expected a finite action of shape {self.low.shape}, got shape {numbers.shape}")
        actions = numbers.astype(np.float64)
        command = self._alone.command
        if not np.isfinite(actions).all():
            wrong = actions[~np.isfinite(actions)][0]
            raise ValueError(f"expected a finite action of shape {self.low.shape}, got {wrong}")
        return actions if command is None else command(worlds_of_one(data), actions[None])[0]

    def cost(self, data: mujoco.MjData) -> float:
        """Return the present effort of one infant."""
        return float(self._alone.effort(worlds_of_one(data))[0])

    @cached_property
    def _alone(self) -> "Actuation":
        command = self.command and stack_terms([self.command])
        return replace(self, effort=stack_terms([self.effort]), command=command)


def bind_actuation(entry: ActuationEntry, model: mujoco.MjModel) -> Actuation:
    """Return the commanded actuators of *entry* in *model*."""
    bound: Actuation = function_of(ACTUATIONS[entry.model].run, "bind")(entry, model)
    return replace(bound, bandwidth_hz=entry.bandwidth_hz)


def numbers_of(actions: npt.ArrayLike) -> npt.NDArray[Any]:
    """Return what may be one action or several as an array of real numbers."""
    try:
        numbers = np.asarray(actions)
    except ValueError:  # Lists of different lengths.
        numbers = np.array(None)
    if numbers.dtype.kind not in "fiub":
        raise ValueError(f"expected an action of numbers, got {actions!r:.60}")
    return numbers


@dataclass(frozen=True)
class Effort(Term):
    """Effort E = Σ u² T / (n Σ T) of n actuators (MIMo), with the largest torque T of each and its share u in use.

    E is between 0 and 1 / n, and 0 if all T are zero; shape (k,).
    """

    used: Term  # Measures what is in use of each actuator, shape (k, n).
    full: FloatArray  # What it measures of an actuator that uses all of its strength, shape (n,).
    torques_nm: FloatArray  # T, shape (n,).
    strength_nm: float  # n Σ T, or 1 if that is zero.

    def __call__(self, worlds: Worlds) -> Any:
        """Return E now."""
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


def as_slice(indices: IntArray) -> IntArray | slice:
    """Return indices that follow each other as a slice, which is read and written faster."""
    first = int(indices[0]) if len(indices) else 0
    return slice(first, first + len(indices)) if (np.diff(indices) == 1).all() else indices


@takes("a bundle, or the folder of one", Bundle, *PATH)
def torque_limits(bundle: Bundle | str | Path) -> dict[str, tuple[float, float]]:
    """Return the peak torques at each actuated hinge joint, in negative and positive direction, in [N m].

    The first is negative. For muscles it is the isometric torque at optimal length; for position actuators it is that
    of the torque motors.

    Args:
        bundle: A bundle, or a bundle folder.

    Raises:
        BundleError: If the folder is not an intact bundle.
        ModelError: If MuJoCo rejects its model.

    Example:
        >>> import mimoc
        >>> limits_nm = mimoc.torque_limits("out/nine_months")
        >>> least, most = limits_nm["robot:right_elbow"]
        >>> least < 0 < most
        True
    """
    bundle = bundle if isinstance(bundle, Bundle) else read_bundle(bundle)
    entry = all_commanded(bundle.manifest.actuation)
    actuation = bind_actuation(entry, load_model(bundle))
    limits: dict[str, tuple[float, float]] = {}
    for actuator, (negative_nm, positive_nm) in zip(entry.actuators, actuation.limits_nm.tolist(), strict=True):
        so_far = limits.get(actuator.joint, (0.0, 0.0))
        limits[actuator.joint] = (so_far[0] + negative_nm, so_far[1] + positive_nm)
    return limits

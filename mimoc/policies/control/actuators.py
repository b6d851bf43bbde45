"""The inverse of actuators: the controls with which motors, servos and muscles give torques at the joints."""

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import ControlError, UnknownNameError
from mimoc.base.mujoco_layout import TIME_CONSTANT, AffineBias
from mimoc.base.units import ms_to_s
from mimoc.bundle.manifest import Manifest
from mimoc.policies.control.forward_model import copy_state
from mimoc.policies.control.infant import DrivenJoints
from mimoc.runtime.actuation import Actuation, bind_actuation
from mimoc.runtime.sense import FloatArray, IntArray

MIN_NM = 1e-9  # Torque at full activation below which an actuator counts as powerless.


def pulls_of(actuation: Actuation) -> FloatArray:
    """Return which way each muscle pulls, -1 or 1, shape (n,); 0 for motors and servos, which turn both ways."""
    return np.sign(actuation.limits_nm.sum(axis=1)) * (actuation.low >= 0.0)


class ActivationFilter:
    """How the activations of a actuators approach their controls: exponentially (MuJoCo's `filterexact`).

    An actuator without an activation is driven by its control at once.
    """

    def __init__(self, model: mujoco.MjModel, actuators: IntArray | slice, interval_s: float):
        """Find the activations of actuators whose controls are kept for some interval."""
        addresses = model.actuator_actadr[actuators]
        self._filtered = np.flatnonzero(addresses >= 0)
        self.states: IntArray = addresses[self._filtered]
        """Where the activations stand in `act`, of those actuators that have one."""
        times_s = model.actuator_dynprm[actuators, TIME_CONSTANT][self._filtered]
        self._approached = 1.0 - np.exp(-interval_s / times_s)

    def controls(self, present: FloatArray, wanted: FloatArray) -> FloatArray:
        """Return the controls, (a,), that bring activations from `act` to wanted ones, (a,), in one interval."""
        controls = wanted.copy()
        if self._filtered.size:
            now = present[self.states]
            controls[self._filtered] = now + (wanted[self._filtered] - now) / self._approached
        return controls


class ActuatorInverse:
    """Inverts MuJoCo's actuators, the torque of which is linear in their activation.

    An actuator gets the control whose filter arrives at the wanted activation after one interval, or comes as near as
    its range allows. Of two antagonistic muscles one pulls and the other rests: a muscle's force is gain x activation
    + bias, which MuJoCo's forces at full and at zero activation determine.
    """

    def __init__(
        self,
        joints: DrivenJoints,
        actuators: IntArray | slice,
        interval_s: float,
        bias: FloatArray | None = None,
    ):
        """Take the a actuators of n hinges, whose controls are kept for some interval.

        Torques are those beside a *bias* of motors and servos, shape (a, mjNBIAS); their whole bias unless given.
        """
        self._model, self._own, self._interval_s = joints.model, actuators, interval_s
        model = joints.model
        self._slot = joints.slots_of(actuators)
        self._count = len(joints.joints)
        self._gear = model.actuator_gear[actuators, 0].copy()
        self._low, self._high = model.actuator_ctrlrange[actuators].T
        self._muscles = bool((model.actuator_gaintype[actuators] == mujoco.mjtGain.mjGAIN_MUSCLE).any())
        self._filter = ActivationFilter(model, actuators, interval_s)
        self._full_nm = model.actuator_gainprm[actuators, 0] * self._gear
        """Torque of each actuator's activation; of muscles, in the state that was measured last."""
        self._limits_nm = model.actuator_forcerange[actuators] * self._gear[:, None]
        self.biases: Any = model.actuator_biasprm[actuators] if bias is None else bias
        """Bias parameters beside which torques are counted, shape (a, mjNBIAS)."""
        self._bias = AffineBias(*(self.biases[:, column] for column in range(len(AffineBias._fields))))

    def rest(self, data: mujoco.MjData) -> FloatArray:
        """Set the activations of a state to zero, and update what all actuators give in it.

        Returns:
            The smallest and the largest torque that they could add at each hinge, shape (n, 2), [N m].
        """
        if self._muscles:
            self._measure_muscles(data)
            limits_nm = np.stack([np.minimum(self._full_nm, 0.0), np.maximum(self._full_nm, 0.0)], axis=1)
        else:
            self._activate(data, 0.0)
            limits_nm = self._limits_nm
        return np.stack([self._by_hinge(limits_nm[:, side]) for side in (0, 1)], axis=1)

    def controls_from_rest(self, present: FloatArray, torques_nm: FloatArray) -> FloatArray:
        """Return the controls, shape (a,), that add torques, shape (n,), to those at rest, as far as strength allows.

        They are for the state that was brought to rest last, which before that had these activations (`act`).
        """
        return self._controls(present, torques_nm[self._slot], np.zeros(len(self._slot)))

    def controls(
        self, scratch: mujoco.MjData, present: FloatArray, torques_nm: FloatArray, speeds_rad_s: FloatArray
    ) -> FloatArray:
        """Return the controls, shape (a,), that give torques at the hinges, as far as strength allows.

        Args:
            scratch: State of the same model, its positions and speeds computed; its activations are overwritten.
            present: `act` of the model now.
            torques_nm: Torque at each hinge, shape (n,).
            speeds_rad_s: Speed that each hinge will have at the end of the interval, shape (n,).
        """
        if self._muscles:
            resting_nm = self._by_hinge(self._measure_muscles(scratch))[self._slot]
        else:
            resting_nm = self._at_zero_activation(scratch, speeds_rad_s)
        return self._controls(present, torques_nm[self._slot], resting_nm)

    def _controls(self, present: FloatArray, torques_nm: FloatArray, resting_nm: FloatArray) -> FloatArray:
        """Return the controls, (a,), for torques at the hinge of each actuator, where they are *resting_nm* at rest."""
        if not self._muscles:  # So that no activation winds up beyond the limits of motors.
            torques_nm = np.minimum(np.maximum(torques_nm, self._limits_nm[:, 0]), self._limits_nm[:, 1])
        is_able = np.abs(self._full_nm) > MIN_NM
        activations = np.divide(torques_nm - resting_nm, self._full_nm, out=np.zeros_like(self._full_nm), where=is_able)
        return self._in_range(self._filter.controls(present, self._in_range(activations)))

    def _in_range(self, controls: FloatArray) -> FloatArray:
        return np.minimum(np.maximum(controls, self._low), self._high)  # Faster than numpy.clip.

    def _at_zero_activation(self, scratch: mujoco.MjData, speeds_rad_s: FloatArray) -> FloatArray:
        """Return what each motor or servo gives at zero activation, shape (a,).

        Servos are stiff: what counts is the angle and the speed at the end of the interval.
        """
        bias, speeds = self._bias, self._gear * speeds_rad_s[self._slot]
        lengths = scratch.actuator_length[self._own] + self._interval_s * speeds
        at_rest = bias.at_zero + bias.by_length * lengths + bias.by_velocity * speeds
        return at_rest * self._gear

    def _measure_muscles(self, data: mujoco.MjData) -> FloatArray:
        """Measure the torque of each muscle's activation; return what each gives at rest, shape (a,)."""
        full_nm, resting_nm = self._activate(data, 1.0), self._activate(data, 0.0)
        self._full_nm = full_nm - resting_nm
        return resting_nm

    def _activate(self, data: mujoco.MjData, level: float) -> FloatArray:
        """Set the activations of a state to a level, and return the torque of each actuator, shape (a,)."""
        data.act[self._filter.states] = level
        mujoco.mj_fwdActuation(self._model, data)
        return data.actuator_force[self._own] * self._gear

    def _by_hinge(self, torques_nm: FloatArray) -> FloatArray:
        """Return the sum of the torques of the actuators of each hinge, shape (n,)."""
        return np.asarray(np.bincount(self._slot, torques_nm, self._count), np.float64)


TORQUE_MODELS = ("torque", "muscle")
"""Actuation models whose commands mean torques; those of servos are angles."""


class Plant:
    """The system under torque control: a copy of an infant's state, and the actions that give torques in it."""

    def __init__(self, model: mujoco.MjModel, manifest: Manifest, chosen: Sequence[str] | None = None):
        """Bind to the n joints that commanded actuators drive, or to chosen ones of them, by name.

        Raises:
            ControlError: If the infant has servos.
            UnknownNameError: If no actuator drives a chosen joint.
        """
        if manifest.actuation.model not in TORQUE_MODELS:
            others = " or ".join(f"{{model: {other}}}" for other in TORQUE_MODELS)
            raise ControlError(
                f"inverse dynamics computes torques, which the actuation model '{manifest.actuation.model}' does not "
                f"accept; build the infant with actuation: {others}"
            )
        actuation = bind_actuation(manifest.actuation, model)
        driven = model.actuator_trnid[actuation.actuators, 0].astype(np.intp)
        joints = DrivenJoints(model, np.array([*dict.fromkeys(driven.tolist())], np.intp), prefix=manifest.prefix)
        if chosen is not None:
            for name in chosen:
                if name not in joints.names:
                    raise UnknownNameError("joint with an actuator", name, joints.names)
            joints = DrivenJoints.named(model, chosen, manifest.prefix)
        self.model = model
        self.data = mujoco.MjData(model)
        self.joints = joints
        self.actuators: IntArray = actuation.actuators
        """All commanded actuators of the infant, in the order of the action."""
        self._commands = np.flatnonzero(np.isin(driven, joints.joints))
        own = actuation.actuators[self._commands]
        self._inverse = ActuatorInverse(joints, own, ms_to_s(manifest.step_ms))
        self._at_rest = np.clip(0.0, actuation.low, actuation.high)
        self._present = self.data.act.copy()
        self.strength_nm: FloatArray = np.zeros(len(joints.joints))
        """Largest torque of each joint, shape (n,)."""
        np.maximum.at(self.strength_nm, joints.slots_of(own), np.abs(actuation.limits_nm[self._commands]).max(axis=1))

    def look(self, observed: mujoco.MjData) -> None:
        """Take over a state but for forces that are applied to joints, with all that is derived from it."""
        copy_state(self.model, observed, self.data)
        self.data.qfrc_applied[:] = 0.0
        mujoco.mj_forward(self.model, self.data)

    @property
    def is_finite(self) -> bool:
        """Whether the state is finite; if not, the simulation became unstable, and the episode is over."""
        return bool(np.isfinite(self.data.qpos).all() and np.isfinite(self.data.qvel).all())

    def rest(self) -> FloatArray:
        """Bring the actuators to rest and update `data.qfrc_actuator`; those of other joints keep their activation.

        Returns:
            The smallest and the largest torque that they could add in this state, shape (n, 2), [N m].
        """
        self._present[:] = self.data.act
        self.data.ctrl[self.actuators] = self._at_rest
        return self._inverse.rest(self.data)

    def action(self, torques_nm: FloatArray) -> npt.NDArray[np.float32]:
        """Return the action that adds torques within their limits, shape (n,), to those at rest.

        The activation that gives them is reached at the end of the control step, if a command can achieve that.
        """
        action = self._at_rest.copy()
        action[self._commands] = self._inverse.controls_from_rest(self._present, torques_nm)
        return action.astype(np.float32)

"""From wanted torques at the joints to the controls of motors, servos or muscles, through their activation filters."""

import mujoco
import numpy as np

from mimoc.mujoco_layout import TIME_CONSTANT, AffineBias
from mimoc.studies.milestones.infant import FloatArray, TrialInfant

LEAST_NM = 1e-9
"""Torque at full activation below which an actuator counts as powerless."""


class DelayedMotors:
    """Inverts MuJoCo's actuators, the torque of which is linear in their activation.

    A filtered actuator gets the control whose filter arrives at the wanted activation after one interval, or comes as
    near as the range of its control allows. Of two antagonistic muscles one pulls and the other rests.
    """

    def __init__(self, infant: TrialInfant, interval_s: float):
        """Find the actuators of each driven hinge of an infant, whose controls are kept for some interval."""
        model = infant.model
        self._model, self._interval_s = model, interval_s
        self._slot = np.searchsorted(infant.joints, model.actuator_trnid[:, 0])
        self._count = len(infant.joints)
        self._gear = model.actuator_gear[:, 0].copy()
        self._low, self._high = model.actuator_ctrlrange.T
        self._muscles = bool((model.actuator_gaintype == mujoco.mjtGain.mjGAIN_MUSCLE).any())
        self._gain = model.actuator_gainprm[:, 0]
        self._bias = AffineBias(*(model.actuator_biasprm[:, column] for column in range(len(AffineBias._fields))))
        filtered = np.flatnonzero(model.actuator_dyntype != mujoco.mjtDyn.mjDYN_NONE)
        self._filtered, self._states = filtered, model.actuator_actadr[filtered]
        times_s = model.actuator_dynprm[filtered, TIME_CONSTANT]
        self._arriving = 1.0 - np.exp(-interval_s / times_s)

    def controls(
        self, scratch: mujoco.MjData, activations: FloatArray, torques_nm: FloatArray, speeds_rad_s: FloatArray
    ) -> FloatArray:
        """Return the controls, shape (nu,), that give torques at the driven hinges, as far as strength allows.

        Args:
            scratch: State of the same model, its positions and speeds computed; its activations are overwritten.
            activations: `act` of the infant now.
            torques_nm: Torque at each driven hinge, shape (n,).
            speeds_rad_s: Speed that each driven hinge will have at the end of the interval, shape (n,).
        """
        wanted = torques_nm[self._slot]
        full, at_rest = self._of_muscles(scratch) if self._muscles else self._of_motors(scratch, speeds_rad_s)
        able = np.abs(full) > LEAST_NM
        level = np.divide(self._clipped(wanted) - at_rest, full, out=np.zeros_like(full), where=able)
        level = np.clip(level, self._low, self._high)
        if self._filtered.size:
            now = activations[self._states]
            level[self._filtered] = now + (level[self._filtered] - now) / self._arriving
        return np.clip(level, self._low, self._high)

    def _clipped(self, torques_nm: FloatArray) -> FloatArray:
        """Return torques within the limits of motors, so that no activation winds up beyond them."""
        if self._muscles:
            return torques_nm
        ends = self._model.actuator_forcerange * self._gear[:, None]
        return np.clip(torques_nm, ends[:, 0], ends[:, 1])

    def _of_motors(self, scratch: mujoco.MjData, speeds_rad_s: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return each motor's or servo's torque per activation, and what it gives at zero activation.

        Servos are stiff: what counts is the angle and the speed at the end of the interval.
        """
        bias, speeds = self._bias, self._gear * speeds_rad_s[self._slot]
        lengths = scratch.actuator_length + self._interval_s * speeds
        at_rest = bias.at_zero + bias.by_length * lengths + bias.by_velocity * speeds
        return self._gain * self._gear, at_rest * self._gear

    def _of_muscles(self, scratch: mujoco.MjData) -> tuple[FloatArray, FloatArray]:
        """Return the torque of each muscle's activation, and what all muscles of its hinge give at rest."""
        torques = []
        for level in (1.0, 0.0):
            scratch.act[:] = level
            mujoco.mj_fwdActuation(self._model, scratch)
            torques.append(scratch.actuator_force * self._gear)
        at_rest = np.asarray(np.bincount(self._slot, torques[1], self._count), np.float64)
        return torques[0] - torques[1], at_rest[self._slot]

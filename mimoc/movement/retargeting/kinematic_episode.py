"""An episode in which an infant is put, at each control step, where a motion has it: a recording like any other.

For the control step in between, forces and torques that inverse dynamics gives are applied to its joints and root: so
it moves on as the motion does. Where a motion has parts of the body within each other or in the ground, these push each
other apart meanwhile, as far as its strength does not keep them there; what it touches then says nothing of reality.
"""

from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np

from mimoc.base.errors import MimocError
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.motion.joint_motion import JointMotion
from mimoc.recording.recorder import Recording
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray
from mimoc.runtime.simulation import STATE, physics_of, set_physics

CORRECTIONS, CLOSE = 6, 2e-3
"""Most corrections of the forces of a control step, and the error, [rad] or [m], below which none is needed."""

STRENGTHS, WEIGHTS = 1.0, 2.0
"""Most that is added against contacts: torque of a joint, in peak torques of its actuators, and force at the root, in
body weights. With more, parts that a motion has within each other are pressed together without measure."""
LEVER_M = 0.1
"""By which that force is taken for the largest torque at the root, and of joints without actuators."""


def record_motion(
    bundle: Bundle, motion: JointMotion, folder: Path, progress: Callable[[int, int], None] = lambda done, total: None
) -> None:
    """Record a motion in a new or empty folder.

    Raises a MimocError if the infant lacks a joint of it or its task ends before it, and a RecordingError or
    RenderingError.
    """
    env = InfantEnv(bundle)
    try:
        puppet = _Puppet(env, motion)
        env.reset(seed=0)
        puppet.put(0)
        env.schedule.reset(env.data)  # What is on its way to the brain is of the first frame.
        at_rest = np.clip(0.0, env.actuation.low, env.actuation.high).astype(np.float32)
        with Recording([env], folder):
            for step in range(puppet.steps):
                puppet.put(step)
                _, _, terminated, truncated, _ = env.step(at_rest)
                if (terminated or truncated) and step + 1 < puppet.steps:
                    raise MimocError(
                        "the task of this child ends its episodes before the motion does; take the key task out of the"
                        " spec"
                    )
                progress(step + 1, puppet.steps)
    finally:
        env.close()


def _limits(env: InfantEnv) -> FloatArray:
    model, actuation = env.model, env.actuation
    weight_n = -float(model.opt.gravity[2]) * float(model.body_subtreemass[model.body(env.manifest.root_body).id])
    limits = np.full(model.nv, WEIGHTS * weight_n * LEVER_M)
    limits[model.jnt_dofadr[model.actuator_trnid[actuation.actuators, 0]]] = 0.0
    for actuator, torques_nm in zip(actuation.actuators, actuation.limits_nm, strict=True):
        speed = model.jnt_dofadr[model.actuator_trnid[actuator, 0]]
        limits[speed] = max(limits[speed], STRENGTHS * float(np.abs(torques_nm).max()))
    for joint in np.flatnonzero(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE):
        limits[model.jnt_dofadr[joint] : model.jnt_dofadr[joint] + 3] = WEIGHTS * weight_n
    return limits


class _Puppet:
    """Puts an infant where a motion has it."""

    def __init__(self, env: InfantEnv, motion: JointMotion):
        step_s = ms_to_s(env.manifest.step_ms)
        self._env, (self._angles, self._speeds) = env, motion.places(env.model)
        self.steps = int(motion.seconds / step_s + 1e-6)
        """Control steps of the motion."""
        self._states = motion.at(step_s * np.arange(self.steps + 1))
        self._model = env.model.__copy__()
        self._model.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_INVDISCRETE)
        self._limits = _limits(env)[self._speeds]
        self._data, self._period = mujoco.MjData(self._model), round(step_s / env.model.opt.timestep)

    def put(self, step: int) -> None:
        """Put it where it is after some control steps, with the forces that move it on."""
        data = self._env.data
        data.qpos[self._angles], data.qvel[self._speeds] = self._states.qpos[step], self._states.qvel[step]
        data.act[:], data.qfrc_applied[:] = 0.0, 0.0
        data.qfrc_applied[self._speeds] = self._forces(step)
        set_physics(self._env.model, data, physics_of(self._env.model, data))

    def _forces(self, step: int) -> FloatArray:
        """Return the forces, constant over a control step, that bring it closest to where it is to be then.

        Those of inverse dynamics are exact for the first physics step; where contacts change, they are corrected.
        """
        model, data, speeds = self._model, self._data, self._speeds
        state = np.empty(mujoco.mj_stateSize(model, STATE))
        mujoco.mj_getState(self._env.model, self._env.data, state, STATE)
        mujoco.mj_setState(model, data, state, STATE)
        data.ctrl[:] = 0.0
        mujoco.mj_forward(model, data)
        data.qacc[speeds] = self._states.qacc[step]
        mujoco.mj_inverse(model, data)
        forces = (data.qfrc_inverse - data.qfrc_actuator)[speeds]
        free = forces + data.qfrc_constraint[speeds]  # As if nothing touched.
        best, smallest = free, np.inf
        for _ in range(CORRECTIONS):
            forces = free + np.clip(forces - free, -self._limits, self._limits)
            errors = self._errors(state, forces, min(step + 1, self.steps))
            if (size := float(np.abs(errors).max())) < smallest:
                best, smallest = forces, size
            if size < CLOSE:
                break
            correction = np.zeros(model.nv)
            mujoco.mj_mulM(model, data, correction, errors)
            forces = forces + correction[speeds] / (model.opt.timestep**2 * self._period * (self._period + 1) / 2)
        return best

    def _errors(self, state: FloatArray, forces: FloatArray, step: int) -> FloatArray:
        """Return what is missing to where it is to be after a control step with forces, shape (nv,)."""
        model, data, errors = self._model, self._data, np.zeros(self._model.nv)
        mujoco.mj_setState(model, data, state, STATE)
        data.ctrl[:], data.qfrc_applied[:] = 0.0, 0.0
        data.qfrc_applied[self._speeds] = forces
        mujoco.mj_step(model, data, self._period)
        wanted = data.qpos.copy()
        wanted[self._angles] = self._states.qpos[step]
        mujoco.mj_differentiatePos(model, errors, 1.0, data.qpos, wanted)
        return errors

"""A recording of a motion: an infant that forces from inverse dynamics move as the motion does."""

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

MAX_CORRECTIONS = 6
"""Most corrections of the forces of a control step."""
CLOSE = 2e-3
"""Error, [rad] or [m], below which no correction is needed."""

STRENGTHS, WEIGHTS = 1.0, 2.0
"""Most that is added against contacts: torque of a joint, in peak torques of its actuators, and force at the root, in
body weights. With more, parts that a motion has within each other are pressed together without measure."""
LEVER_M = 0.1
"""Lever at which that force gives the largest torque at the root, and of joints without actuators."""


def record_motion(
    bundle: Bundle, motion: JointMotion, folder: Path, progress: Callable[[int, int], None] = lambda done, total: None
) -> None:
    """Record a motion in a new or empty folder, with the infant where the motion has it at each control step.

    Within a control step, forces and torques from inverse dynamics are applied to the infant's joints and root, so that
    it moves as the motion does. Parts of the body that overlap or are in the ground push each other apart meanwhile, as
    far as these forces, which are limited, do not keep them there; touch is then not realistic.

    Raises:
        MimocError: If the infant lacks a joint of the motion, or its task ends before the motion does.
        RecordingError: If the infant or the folder cannot be used for a recording.
        RenderingError: If the infant has vision, and there is no OpenGL here.
    """
    env = InfantEnv(bundle)
    try:
        puppet = _Puppet(env, motion)
        env.reset(seed=0)
        puppet.put(0)
        env.schedule.reset(env.data)  # Delayed signals are then those of the first frame.
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


class _Puppet:
    """Puts an infant where a motion has it."""

    def __init__(self, env: InfantEnv, motion: JointMotion):
        step_s = ms_to_s(env.manifest.step_ms)
        self._env = env
        self._angles, self._speeds = motion.places(env.model)
        self.steps = int(motion.seconds / step_s + 1e-6)
        """Control steps of the motion."""
        self._states = motion.at(step_s * np.arange(self.steps + 1))
        self._model = env.model.__copy__()
        self._model.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_INVDISCRETE)
        self._limits = _limits(env)[self._speeds]
        self._data = mujoco.MjData(self._model)
        self._substeps = round(step_s / env.model.opt.timestep)

    def put(self, step: int) -> None:
        """Put the infant where it is after *step* control steps, with the forces that move it until the next one."""
        data = self._env.data
        data.qpos[self._angles] = self._states.qpos[step]
        data.qvel[self._speeds] = self._states.qvel[step]
        data.act[:] = 0.0
        data.qfrc_applied[:] = 0.0
        data.qfrc_applied[self._speeds] = self._forces(step)
        set_physics(self._env.model, data, physics_of(self._env.model, data))

    def _forces(self, step: int) -> FloatArray:
        """Return the constant forces that bring the infant closest to where it is to be after the next control step.

        The forces of inverse dynamics are exact for the first physics step; where contacts change, they are corrected.
        In P semi-implicit physics steps of dt, a constant acceleration a moves a joint by a dt^2 P (P + 1) / 2. So what
        is missing, e, is corrected by the force M e / (dt^2 P (P + 1) / 2), with the inertia matrix M.
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
        without_contacts = forces + data.qfrc_constraint[speeds]
        travel_s2 = model.opt.timestep**2 * self._substeps * (self._substeps + 1) / 2  # Travel at unit acceleration.
        best, smallest_error = without_contacts, np.inf
        for _ in range(MAX_CORRECTIONS):
            against_contacts = np.clip(forces - without_contacts, -self._limits, self._limits)
            forces = without_contacts + against_contacts
            errors = self._errors(state, forces, min(step + 1, self.steps))
            largest_error = float(np.abs(errors).max())
            if largest_error < smallest_error:
                best, smallest_error = forces, largest_error
            if largest_error < CLOSE:
                break
            correction = np.zeros(model.nv)
            mujoco.mj_mulM(model, data, correction, errors)
            forces = forces + correction[speeds] / travel_s2
        return best

    def _errors(self, state: FloatArray, forces: FloatArray, step: int) -> FloatArray:
        """Return what the infant misses of the motion at *step* if it starts from a state with forces, shape (nv,)."""
        model, data = self._model, self._data
        mujoco.mj_setState(model, data, state, STATE)
        data.ctrl[:] = 0.0
        data.qfrc_applied[:] = 0.0
        data.qfrc_applied[self._speeds] = forces
        mujoco.mj_step(model, data, self._substeps)
        wanted = data.qpos.copy()
        wanted[self._angles] = self._states.qpos[step]
        errors = np.zeros(model.nv)
        mujoco.mj_differentiatePos(model, errors, 1.0, data.qpos, wanted)
        return errors


def _limits(env: InfantEnv) -> FloatArray:
    """Return the most that is added against contacts at each degree of freedom, [N] or [N m], shape (nv,)."""
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

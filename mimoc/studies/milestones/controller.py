"""The controller of all trials: a saturating spring and damper at every joint, around a posture.

Torque = compensation + K (target - angle) - D speed, clipped by the infant's own strength, with K = I w² and D = 2 I w;
w is one natural frequency for all joints, ages and trials, and I is the inertia that the joint has to move: the larger
of what hangs on it and what it hangs on, of which each limb of a pair bears half.
The compensation cancels the joint's own spring and the weight of what hangs on it. The damper is evaluated implicitly
(Tan, Liu & Turk 2011, stable
proportional-derivative control), so that stiff joints of light parts do not shake with physics steps of 5 ms.
"""

import copy
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.bundle.model import in_subtrees
from mimoc.compiler.validation.requests import ROOT
from mimoc.studies.milestones.infant import GRAVITY_M_S2, FloatArray, IntArray, TrialInfant
from mimoc.studies.milestones.motors import DelayedMotors

FREQUENCY_RAD_S = 14.0
"""Natural frequency w, the same for all: just below 1 / 60 ms, where the filters of activation would make it shake."""
PAIRED = ("left_", "right_")


@dataclass(frozen=True)
class Servo:
    """Stiffness and damping of each driven hinge, shape (n,) each."""

    stiffness_nm: FloatArray
    damping_nms: FloatArray


def servo(infant: TrialInfant, data: mujoco.MjData, factor: float = 1.0) -> Servo:
    """Return the gains of an infant in a posture.

    Args:
        infant: The infant.
        data: The posture, positions computed.
        factor: Factor on the natural frequency.
    """
    frequency = factor * FREQUENCY_RAD_S
    inertia_kgm2 = np.array([_inertia(infant, data, joint) for joint in infant.joints])
    return Servo(frequency**2 * inertia_kgm2, 2.0 * frequency * inertia_kgm2)


class Controller:
    """Computes controls that keep the joints at target angles."""

    def __init__(self, infant: TrialInfant, gains: Servo, interval_s: float):
        """Prepare a twin of the model, whose inertia has the damping of one interval in it.

        Args:
            infant: The infant.
            gains: Stiffness and damping of its joints.
            interval_s: How long controls are kept: a physics step or several.
        """
        self._infant, self._gains = infant, gains
        self._twin = copy.copy(infant.model)
        self._interval_s = interval_s
        self._step_damping = gains.damping_nms * interval_s
        self._twin.dof_armature[infant.dofs] += self._step_damping
        off = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT
        self._twin.opt.disableflags |= int(off)
        self._scratch = mujoco.MjData(self._twin)
        self._acceleration = np.zeros((1, infant.model.nv))
        self._motors = DelayedMotors(infant, interval_s)
        self._loads = _loads(infant)

    def __call__(self, data: mujoco.MjData, target_rad: FloatArray) -> FloatArray:
        """Return the controls, shape (nu,), in a state.

        Args:
            data: The state, as it is after a physics step.
            target_rad: Angle of each driven hinge to go to, shape (n,).
        """
        torques_nm = self._torques(data, target_rad)
        speeds = data.qvel[self._infant.dofs] + self._interval_s * self._acceleration[0, self._infant.dofs]
        return self._motors.controls(self._scratch, data.act, torques_nm, speeds)

    def _torques(self, data: mujoco.MjData, target_rad: FloatArray) -> FloatArray:
        infant, gains, scratch = self._infant, self._gains, self._scratch
        scratch.qpos[:], scratch.qvel[:] = data.qpos, data.qvel
        mujoco.mj_fwdPosition(self._twin, scratch)
        mujoco.mj_fwdVelocity(self._twin, scratch)
        angles, speeds = data.qpos[infant.angles], data.qvel[infant.dofs]
        ahead = angles + self._interval_s * speeds
        wanted = gains.stiffness_nm * (target_rad - ahead) - gains.damping_nms * speeds + self._compensation(scratch)
        force = scratch.qfrc_passive + data.qfrc_constraint - scratch.qfrc_bias
        force[infant.dofs] += wanted
        mujoco.mj_solveM(self._twin, scratch, self._acceleration, force[None])
        return wanted - self._step_damping * self._acceleration[0, infant.dofs]

    def _compensation(self, scratch: mujoco.MjData) -> FloatArray:
        """Return the torques that cancel springs and the weight of what hangs on the joints, shape (n,)."""
        joints = self._loads.joints
        arms_m = scratch.subtree_com[self._loads.bodies] - scratch.xanchor[joints]
        axes = scratch.xaxis[joints]
        moments_nm = self._loads.weights_n * (axes[:, 1] * arms_m[:, 0] - axes[:, 0] * arms_m[:, 1])
        loads_nm = scratch.qfrc_spring[self._loads.dofs] + moments_nm
        carried_nm = np.bincount(self._loads.slots, loads_nm * self._loads.ratios, len(self._infant.joints))
        return -np.asarray(carried_nm, np.float64)


@dataclass(frozen=True)
class _Loads:
    """Hinges whose loads the motors carry: the driven ones, and those that a tendon couples to one of them."""

    joints: IntArray
    slots: IntArray
    """Index of the driven hinge that carries the load of each."""
    ratios: FloatArray
    """Rotation of each by that of its driven hinge."""
    bodies: IntArray
    """The body that each moves."""
    dofs: IntArray
    weights_n: FloatArray
    """Weight of what hangs on each."""


def _loads(infant: TrialInfant) -> _Loads:
    """Return the driven hinges and those coupled to them, as hip_bend2 is to hip_bend1."""
    model, slots = infant.model, {int(joint): slot for slot, joint in enumerate(infant.joints)}
    loads = [(joint, slot, 1.0) for joint, slot in slots.items()]
    for start, count in zip(model.tendon_adr, model.tendon_num, strict=True):
        wraps = slice(start, start + count)
        factors = dict(zip(model.wrap_objid[wraps].tolist(), model.wrap_prm[wraps].tolist(), strict=True))
        driven, free = (
            [joint for joint in factors if joint in slots],
            [joint for joint in factors if joint not in slots],
        )
        if len(driven) == len(free) == 1:
            loads.append((free[0], slots[driven[0]], -factors[driven[0]] / factors[free[0]]))
    joints, owners, ratios = zip(*loads, strict=True)
    at = np.array(joints, np.intp)
    bodies, dofs = model.jnt_bodyid[at].astype(np.intp), model.jnt_dofadr[at].astype(np.intp)
    weights_n = GRAVITY_M_S2 * model.body_subtreemass[bodies]
    return _Loads(at, np.array(owners, np.intp), np.array(ratios), bodies, dofs, weights_n)


def _inertia(infant: TrialInfant, data: mujoco.MjData, joint: int) -> float:
    """Return the inertia about a hinge of what it has to move, in [kg m²]."""
    model = infant.model
    body = int(model.jnt_bodyid[joint])
    belongs = model.body_rootid == model.body(ROOT).id
    outer = in_subtrees(model, [body])
    hanging = _about(model, data, joint, np.flatnonzero(outer))
    if model.body(body).name.endswith("_eye"):
        return hanging
    bearing = _about(model, data, joint, np.flatnonzero(belongs & ~outer))
    return max(hanging, bearing / 2 if model.body(body).name.startswith(PAIRED) else 0.0)


def _about(model: mujoco.MjModel, data: mujoco.MjData, joint: int, bodies: np.ndarray) -> float:
    """Return the inertia of some bodies about the axis of a hinge, with the armature of its motor."""
    axis = data.xaxis[joint]
    arms_m = data.xipos[bodies] - data.xanchor[joint]
    across_m = arms_m - np.outer(arms_m @ axis, axis)
    along = np.einsum("bij,i->bj", data.ximat[bodies].reshape(-1, 3, 3), axis)
    turning = np.sum(model.body_inertia[bodies] * along**2) + model.body_mass[bodies] @ np.sum(across_m**2, axis=1)
    return float(turning + model.dof_armature[model.jnt_dofadr[joint]])

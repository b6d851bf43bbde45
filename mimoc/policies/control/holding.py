"""A controller that holds postures: a saturating spring and damper at every joint.

Torque = compensation + K (target - angle) - D speed, clipped by the infant's own strength, with K = I w² and D = 2 I w;
w is one natural frequency for all joints, ages and postures, and I is the inertia that the joint has to move: the
larger of what hangs on it and what it hangs on, of which each limb of a pair bears half.
The compensation cancels the joint's own spring and the weight of what hangs on it. The damper is evaluated implicitly
(Tan, Liu & Turk 2011, stable proportional-derivative control), so that stiff joints of light parts do not shake with
physics steps of 5 ms. Wanted torques become the controls of motors, servos or muscles, through their activation
filters.
"""

import copy
from collections.abc import Callable, Collection
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.units import GRAVITY_M_S2
from mimoc.bundle.model import in_subtrees
from mimoc.policies.control.actuators import ActuatorInverse
from mimoc.policies.control.forward_model import OWN_STATE, ForwardModel
from mimoc.policies.control.infant import DrivenInfant
from mimoc.runtime.delays import Timing
from mimoc.runtime.sense import FloatArray, IntArray

FREQUENCY_RAD_S = 14.0
"""Natural frequency w, the same for all: just below 1 / 60 ms, where the filters of activation would make it shake."""
PAIRED = ("left_", "right_")


@dataclass(frozen=True)
class Servo:
    """Stiffness and damping of each driven hinge, shape (n,) each."""

    stiffness_nm: FloatArray
    damping_nms: FloatArray


def servo(
    infant: DrivenInfant, data: mujoco.MjData, factor: float = 1.0, loose: Collection[int] = frozenset()
) -> Servo:
    """Return the gains of an infant in a posture, positions computed; *loose* hinges bear nothing."""
    frequency = factor * FREQUENCY_RAD_S
    bears = [slot not in loose for slot in range(len(infant.joints))]
    inertia_kgm2 = np.array([_inertia(infant, data, *pair) for pair in zip(infant.joints, bears, strict=True)])
    return Servo(frequency**2 * inertia_kgm2, 2.0 * frequency * inertia_kgm2)


class Controller:
    """Computes controls that keep the joints of an infant at target angles."""

    def __init__(self, infant: DrivenInfant, gains: Servo, interval_s: float):
        """Prepare a twin of the model, whose inertia has the damping of one interval between controls in it."""
        self._infant, self._gains = infant, gains
        self._twin = copy.copy(infant.model)
        self._interval_s = interval_s
        self._step_damping = gains.damping_nms * interval_s
        self._twin.dof_armature[infant.dofs] += self._step_damping
        off = mujoco.mjtDisableBit.mjDSBL_CONSTRAINT | mujoco.mjtDisableBit.mjDSBL_CONTACT
        self._twin.opt.disableflags |= int(off)
        self._scratch = mujoco.MjData(self._twin)
        self._acceleration = np.zeros((1, infant.model.nv))
        self._inverse = ActuatorInverse(infant, infant.actuators, interval_s)
        self._loads = _loads(infant)

    def __call__(self, data: mujoco.MjData, target_rad: FloatArray) -> FloatArray:
        """Return the controls, (nu,), for angles of all driven hinges, (n,), after a physics step; others' stay."""
        torques_nm = self._torques(data, target_rad)
        dofs = self._infant.dofs
        speeds = data.qvel.take(dofs) + self._interval_s * self._acceleration[0].take(dofs)
        controls = data.ctrl.copy()
        controls[self._infant.actuators] = self._inverse.controls(self._scratch, data.act, torques_nm, speeds)
        return controls

    def _torques(self, data: mujoco.MjData, target_rad: FloatArray) -> FloatArray:
        infant, gains, scratch = self._infant, self._gains, self._scratch
        scratch.qpos[:], scratch.qvel[:] = data.qpos, data.qvel
        mujoco.mj_fwdPosition(self._twin, scratch)
        mujoco.mj_fwdVelocity(self._twin, scratch)
        angles, speeds = data.qpos.take(infant.angles), data.qvel.take(infant.dofs)
        ahead = angles + self._interval_s * speeds
        # Torques that cancel springs and the weight of what hangs on the joints.
        loads = self._loads
        arms_m = scratch.subtree_com.take(loads.bodies, 0) - scratch.xanchor.take(loads.joints, 0)
        axes = scratch.xaxis.take(loads.joints, 0)
        moments_nm = loads.weights_n * (axes[:, 1] * arms_m[:, 0] - axes[:, 0] * arms_m[:, 1])
        loads_nm = scratch.qfrc_spring.take(loads.dofs) + moments_nm
        carried_nm = np.bincount(loads.slots, loads_nm * loads.ratios, len(self._infant.joints))
        wanted = gains.stiffness_nm * (target_rad - ahead) - gains.damping_nms * speeds - carried_nm
        force = scratch.qfrc_passive + data.qfrc_constraint - scratch.qfrc_bias
        force[infant.dofs] += wanted
        mujoco.mj_solveM(self._twin, scratch, self._acceleration, force[None])
        return wanted - self._step_damping * self._acceleration[0].take(infant.dofs)


@dataclass(frozen=True)
class _Loads:
    """Hinges whose loads the motors carry: the driven ones, and those that a tendon couples to one of them."""

    joints: IntArray
    slots: IntArray  # Index of the driven hinge that carries the load of each.
    ratios: FloatArray  # Rotation of each by that of its driven hinge.
    bodies: IntArray  # The body that each moves.
    dofs: IntArray
    weights_n: FloatArray  # Weight of what hangs on each.


def _loads(infant: DrivenInfant) -> _Loads:
    """Return the driven hinges and those coupled to them, as hip_bend2 is to hip_bend1."""
    model = infant.model
    slots = {int(joint): slot for slot, joint in enumerate(infant.joints)}
    loads = [(joint, slot, 1.0) for joint, slot in slots.items()]
    for start, count in zip(model.tendon_adr, model.tendon_num, strict=True):
        wraps = slice(start, start + count)
        if (model.wrap_type[wraps] != mujoco.mjtWrap.mjWRAP_JOINT).any():
            continue  # It is the ribbon of an object.
        factors = dict(zip(model.wrap_objid[wraps].tolist(), model.wrap_prm[wraps].tolist(), strict=True))
        driven = [joint for joint in factors if joint in slots]
        free = [joint for joint in factors if joint not in slots]
        if len(driven) == len(free) == 1:
            loads.append((free[0], slots[driven[0]], -factors[driven[0]] / factors[free[0]]))
    joints, owners, ratios = zip(*loads, strict=True)
    at = np.array(joints, np.intp)
    bodies, dofs = model.jnt_bodyid[at].astype(np.intp), model.jnt_dofadr[at].astype(np.intp)
    weights_n = GRAVITY_M_S2 * model.body_subtreemass[bodies]
    return _Loads(at, np.array(owners, np.intp), np.array(ratios), bodies, dofs, weights_n)


def _inertia(infant: DrivenInfant, data: mujoco.MjData, joint: int, bears: bool) -> float:
    """Return the inertia about a hinge of what it has to move, in [kg m²]."""
    model = infant.model
    body = int(model.jnt_bodyid[joint])
    outer = in_subtrees(model, [body])
    hanging = _about(model, data, joint, np.flatnonzero(outer))
    if not bears or infant.part(body).endswith("_eye"):
        return hanging
    bearing = _about(model, data, joint, np.flatnonzero(infant.is_own & ~outer))
    return max(hanging, bearing / 2 if infant.part(body).startswith(PAIRED) else 0.0)


def _about(model: mujoco.MjModel, data: mujoco.MjData, joint: int, bodies: np.ndarray) -> float:
    """Return the inertia of some bodies about the axis of a hinge, with the armature of its motor."""
    axis = data.xaxis[joint]
    arms_m = data.xipos[bodies] - data.xanchor[joint]
    across_m = arms_m - np.outer(arms_m @ axis, axis)
    along = np.einsum("bij,i->bj", data.ximat[bodies].reshape(-1, 3, 3), axis)
    turning = np.sum(model.body_inertia[bodies] * along**2) + model.body_mass[bodies] @ np.sum(across_m**2, axis=1)
    return float(turning + model.dof_armature[model.jnt_dofadr[joint]])


Propose = Callable[[mujoco.MjData, IntArray], FloatArray]
"""From a state with all that is derived from it, and some of the driven hinges, to the angle that each hinge is to go
to, shape (n,); those of hinges that were not asked for are not used."""


class Rehearsal:
    """Finds the commands of a control step with a forward model, for each joint over its own delay.

    The controller acts from when a command sent now acts. The mean of what it does in the control step that begins then
    is sent; what it does of the arms after that is not sent, but predicted for the legs, whose delay is longer.

    So a posture is held as well with control steps of 20 ms as with one command for each physics step, and the delay of
    the legs makes no arm act too early or too late.
    """

    def __init__(self, infant: DrivenInfant, gains: Servo, actuators: IntArray, timing: Timing):
        """Prepare a copy of the infant and its world; actuators but the m given ones keep their controls."""
        self._model, self._actuators = infant.model, actuators
        self._control = Controller(infant, gains, infant.model.opt.timestep)
        self._forward = ForwardModel(infant.model, actuators, timing, OWN_STATE)
        self._all_hinges = np.arange(len(infant.joints))
        self._hinges = infant.slots_of(actuators)

    @property
    def delay_steps(self) -> IntArray:
        """Physics steps after which commands act, shape (m,)."""
        return self._forward.delay_steps

    def hold(self, data: mujoco.MjData, target_rad: FloatArray) -> FloatArray:
        """Return the commands that keep hinges at angles, shape (m,), and take them to be on their way already."""
        now = self._forward.copied(data)
        mujoco.mj_forward(self._model, now)
        held = self._control(now, target_rad)[self._actuators]
        self._forward.hold(held)
        return held

    def __call__(self, data: mujoco.MjData, propose: Propose) -> FloatArray:
        """Return the commands to send now, shape (m,).

        *propose*, which says where hinges go, is asked once for each delay, in the state in which the commands with
        that delay begin to act: the first time for all hinges, later for those alone.
        """
        forward = self._forward
        total = np.zeros(len(self._actuators))
        target_rad = np.empty(0)
        for step, ahead, beginning in forward.foresee(data, forward.longest + forward.control_steps):
            if beginning:
                forward.compute()
                hinges = self._hinges[beginning.commands]
                if target_rad.size:
                    target_rad[hinges] = propose(ahead, hinges)[hinges]
                else:
                    target_rad = propose(ahead, self._all_hinges).copy()
            if not (begun := forward.begun(step)):
                continue
            controls = self._control(ahead, target_rad)
            for group in begun:
                ahead.ctrl[group.actuators] = controls[group.actuators]
                if step < group.end:
                    total[group.commands] += controls[group.actuators]
        forward.send(commands := total / forward.control_steps)
        return commands

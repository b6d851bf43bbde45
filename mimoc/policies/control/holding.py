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
from mimoc.policies.control.estimate import Estimate
from mimoc.policies.control.forward_model import OWN_STATE, ForwardModel
from mimoc.policies.control.infant import DrivenInfant
from mimoc.runtime.delays import Timing
from mimoc.runtime.sense import FloatArray, IntArray

FREQUENCY_RAD_S = 14.0
"""Natural frequency w, the same for all: just below 1 / 60 ms, where the filters of activation would make it shake."""
ESTIMATED_RAD_S = 10.0
"""The same of a posture that is held by an estimate of the body, whose errors a stiff servo turns into torques that
saturate muscles: at 14 rad/s, hips of a sitting infant do at 1 to 3 degrees. Fitted to sitting at 6 to 12 months."""
RESTING_S = 1.0  # After which a posture that can be held is at rest on the floor (a choice).
EYE_FREQUENCY_RAD_S = 60.0
"""Natural frequency of eyes whose gaze is directed: their muscles are filtered over 10 ms only."""
PAIRED = ("left_", "right_")


@dataclass(frozen=True)
class Servo:
    """Stiffness and damping of each driven hinge, shape (n,) each."""

    stiffness_nm: FloatArray
    damping_nms: FloatArray


def servo(
    infant: DrivenInfant,
    data: mujoco.MjData,
    factor: float = 1.0,
    loose: Collection[int] = frozenset(),
    frequency_rad_s: float | FloatArray = FREQUENCY_RAD_S,
) -> Servo:
    """Return the gains of an infant in a posture, positions computed; *loose* hinges bear nothing.

    Natural frequencies are one for all hinges, or of each, shape (n,).
    """
    frequency = factor * frequency_rad_s
    bears = [slot not in loose for slot in range(len(infant.joints))]
    inertia_kgm2 = np.array([_inertia(infant, data, *pair) for pair in zip(infant.joints, bears, strict=True)])
    return Servo(frequency**2 * inertia_kgm2, 2.0 * frequency * inertia_kgm2)


class Controller:
    """Computes controls that keep the joints of an infant at target angles."""

    def __init__(self, infant: DrivenInfant, gains: Servo, interval_s: float, pairs: bool = False):
        """Prepare a twin of the model, whose inertia has the damping of one interval between controls in it.

        With *pairs*, hinges that a tendon couples count as one, which turns by the mean of both: the light part between
        them shakes, and what they carry does not.
        """
        self.model = infant.model
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
        self._pairs = _pairs(infant, self._loads) if pairs else None
        self._carried_n = self._loads.weights_n

    def let_lie(self, data: mujoco.MjData, slots: IntArray) -> None:
        """Leave the weight of limbs that lie on something in a state to it, of driven hinges *slots*, shape (k,)."""
        model, loads, is_own = self.model, self._loads, self._infant.is_own
        pairs = model.geom_bodyid[data.contact.geom]
        outside = is_own[pairs].sum(axis=1) == 1
        borne = np.unique(pairs[outside][is_own[pairs[outside]]])
        lies = np.zeros(model.nbody, bool)
        for body in borne.tolist():
            while body != self._infant.root and body:
                lies[body] = True
                body = int(model.body_parentid[body])
        self._carried_n = np.where(lies[loads.bodies] & np.isin(loads.slots, slots), 0.0, loads.weights_n)

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
        if self._pairs:
            angles, speeds = self._pairs.of_angles(data.qpos), self._pairs.of_speeds(data.qvel)
        ahead = angles + self._interval_s * speeds
        # Torques that cancel springs and the weight of what hangs on the joints.
        loads = self._loads
        arms_m = scratch.subtree_com.take(loads.bodies, 0) - scratch.xanchor.take(loads.joints, 0)
        axes = scratch.xaxis.take(loads.joints, 0)
        moments_nm = self._carried_n * (axes[:, 1] * arms_m[:, 0] - axes[:, 0] * arms_m[:, 1])
        loads_nm = scratch.qfrc_spring.take(loads.dofs) + moments_nm
        carried_nm = np.bincount(loads.slots, loads_nm * loads.ratios, len(self._infant.joints))
        wanted = gains.stiffness_nm * (target_rad - ahead) - gains.damping_nms * speeds - carried_nm
        force = scratch.qfrc_passive + data.qfrc_constraint - scratch.qfrc_bias
        force[infant.dofs] += wanted
        mujoco.mj_solveM(self._twin, scratch, self._acceleration, force[None])
        acceleration = self._acceleration[0]
        return wanted - self._step_damping * (
            self._pairs.of_speeds(acceleration) if self._pairs else acceleration.take(infant.dofs)
        )


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


@dataclass(frozen=True)
class _Pairs:
    """For each driven hinge, the one that a tendon couples to it, or itself."""

    first: tuple[IntArray, IntArray]  # Where angle and speed of each driven hinge stand, shape (n,) each.
    second: tuple[IntArray, IntArray]  # The same of the other.
    ratios: FloatArray  # Rotation of the other by that of the first.

    def of_angles(self, qpos: FloatArray) -> FloatArray:
        """Return the mean angle of each pair, shape (n,)."""
        return (qpos.take(self.first[0]) + qpos.take(self.second[0]) / self.ratios) / 2

    def of_speeds(self, qvel: FloatArray) -> FloatArray:
        """Return the mean speed, or acceleration, of each pair, shape (n,)."""
        return (qvel.take(self.first[1]) + qvel.take(self.second[1]) / self.ratios) / 2


def _pairs(infant: DrivenInfant, loads: _Loads) -> _Pairs:
    second, ratios = infant.joints.copy(), np.ones(len(infant.joints))
    second[loads.slots], ratios[loads.slots] = loads.joints, loads.ratios  # Coupled hinges come last.
    model = infant.model
    places, speeds = model.jnt_qposadr[second].astype(np.intp), model.jnt_dofadr[second].astype(np.intp)
    return _Pairs((infant.angles, infant.dofs), (places, speeds), ratios)


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


class EstimatedHolding:
    """Finds the commands of a control step from what an infant takes the state of its body to be.

    The estimate is of the time at which commands sent now act, so nothing has to be foreseen beyond it: the controller
    acts in it, physics step by physics step, and the mean of what it does is sent.
    """

    def __init__(self, infant: DrivenInfant, gains: Servo, actuators: IntArray, rows: IntArray, estimate: Estimate):
        """Bind it to an estimate of m actuators, of which those in *rows*, shape (r,), are moved."""
        self._actuators = actuators
        self._rows = rows
        self._control = Controller(infant, gains, infant.model.opt.timestep, pairs=True)
        self._all_hinges = np.arange(len(infant.joints))
        self.estimate = estimate

    def settled(self, data: mujoco.MjData, target_rad: FloatArray, rest: FloatArray, lying: IntArray) -> mujoco.MjData:
        """Return the state in which hinges come to rest that are held at angles, by a controller that knows all.

        Of the limbs of the hinges *lying*, those that then lie on something are no longer carried. *rest* are the
        commands of all actuators at rest, shape (m,).
        """
        state = copy.copy(data)
        state.ctrl[self._actuators] = rest
        self._come_to_rest(state, target_rad)
        self._control.let_lie(state, lying)
        self._come_to_rest(state, target_rad)
        return state

    def _come_to_rest(self, state: mujoco.MjData, target_rad: FloatArray) -> None:
        model, moved = self._control.model, self._actuators[self._rows]
        for _ in range(round(RESTING_S / model.opt.timestep)):
            state.ctrl[moved] = self._control(state, target_rad)[moved]
            mujoco.mj_step(model, state)
        mujoco.mj_forward(model, state)

    def begin(self, data: mujoco.MjData, settled: mujoco.MjData) -> None:
        """Begin an episode in a state, with the controls and activations of the settled one."""
        data.ctrl[self._actuators] = settled.ctrl[self._actuators]
        data.act[:] = settled.act
        self.estimate.begin(data, settled.ctrl[self._actuators].copy(), settled)

    def __call__(self, propose: Propose, rest: FloatArray) -> FloatArray:
        """Return the commands of `rows` to send now, shape (r,); *propose* says where hinges go; see `Rehearsal`."""
        estimate = self.estimate
        target_rad = propose(estimate.data, self._all_hinges).copy()
        total = np.zeros(len(self._actuators))
        commands = rest.copy()
        moved = self._actuators[self._rows]
        for number in range(estimate.control_steps):
            commands[self._rows] = self._control(estimate.data, target_rad)[moved]
            estimate.advance(number, commands)
            total += commands
        return estimate.send(total / estimate.control_steps)[self._rows]

    @property
    def delay_steps(self) -> IntArray:
        """Physics steps after which commands of `rows` act, shape (r,)."""
        return self.estimate.delay_steps[self._rows]

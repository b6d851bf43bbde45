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
from collections import deque
from collections.abc import Callable, Collection
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.mujoco_layout import TIME_CONSTANT, AffineBias
from mimoc.base.units import GRAVITY_M_S2
from mimoc.bundle.model import in_subtrees
from mimoc.policies.control.holding.postures import DrivenInfant
from mimoc.runtime.delays.signals import Timing, within
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.senses import MOTOR

LEAST_NM = 1e-9  # Torque at full activation below which an actuator counts as powerless.


class DelayedMotors:
    """Inverts MuJoCo's actuators, the torque of which is linear in their activation.

    A filtered actuator gets the control whose filter arrives at the wanted activation after one interval, or comes as
    near as the range of its control allows. Of two antagonistic muscles one pulls and the other rests.
    """

    def __init__(self, infant: DrivenInfant, interval_s: float, bias: FloatArray | None = None):
        """Find the a actuators of the driven hinges of an infant, whose controls are kept for some interval.

        Torques are those beside a *bias* of motors and servos, shape (a, mjNBIAS); their whole bias unless given.
        """
        model, own = infant.model, infant.actuators
        self._model, self._own, self._interval_s = model, own, interval_s
        self._slot, self._count = infant.slots_of(own), len(infant.joints)
        self._gear = model.actuator_gear[own, 0].copy()
        self._low, self._high = model.actuator_ctrlrange[own].T
        self._weakest_nm, self._strongest_nm = (model.actuator_forcerange[own] * self._gear[:, None]).T
        self._muscles = bool((model.actuator_gaintype[own] == mujoco.mjtGain.mjGAIN_MUSCLE).any())
        self._full = model.actuator_gainprm[own, 0] * self._gear
        """Torque of each motor's or servo's activation."""
        self._able = np.abs(self._full) > LEAST_NM
        self._all_able = bool(self._able.all())
        self.biases: Any = model.actuator_biasprm[own] if bias is None else bias
        """Bias parameters beside which torques are counted, shape (a, mjNBIAS)."""
        self._bias = AffineBias(*(self.biases[:, column] for column in range(len(AffineBias._fields))))
        filtered = np.flatnonzero(model.actuator_dyntype[own] != mujoco.mjtDyn.mjDYN_NONE)
        self._filtered, self._states = filtered, model.actuator_actadr[own][filtered]
        times_s = model.actuator_dynprm[own][filtered, TIME_CONSTANT]
        self._arriving = 1.0 - np.exp(-interval_s / times_s)

    def controls(
        self, scratch: mujoco.MjData, activations: FloatArray, torques_nm: FloatArray, speeds_rad_s: FloatArray
    ) -> FloatArray:
        """Return the controls, shape (a,), that give torques at the driven hinges, as far as strength allows.

        Args:
            scratch: State of the same model, its positions and speeds computed; its activations are overwritten.
            activations: `act` of the model now.
            torques_nm: Torque at each driven hinge, shape (n,).
            speeds_rad_s: Speed that each driven hinge will have at the end of the interval, shape (n,).
        """
        wanted = torques_nm[self._slot]
        if self._muscles:
            full, at_rest = self._of_muscles(scratch)
            level = _divided(wanted - at_rest, full, np.abs(full) > LEAST_NM)
        else:
            missing = self._clipped(wanted) - self._of_motors(scratch, speeds_rad_s)
            level = missing / self._full if self._all_able else _divided(missing, self._full, self._able)
        level = self._in_range(level)
        if self._filtered.size:
            now = activations[self._states]
            level[self._filtered] = now + (level[self._filtered] - now) / self._arriving
        return self._in_range(level)

    def _in_range(self, controls: FloatArray) -> FloatArray:
        return np.minimum(np.maximum(controls, self._low), self._high)  # Faster than numpy.clip.

    def _clipped(self, torques_nm: FloatArray) -> FloatArray:
        """Return torques within the limits of motors, so that no activation winds up beyond them."""
        return np.minimum(np.maximum(torques_nm, self._weakest_nm), self._strongest_nm)

    def _of_motors(self, scratch: mujoco.MjData, speeds_rad_s: FloatArray) -> FloatArray:
        """Return what each motor or servo gives at zero activation.

        Servos are stiff: what counts is the angle and the speed at the end of the interval.
        """
        bias, speeds = self._bias, self._gear * speeds_rad_s[self._slot]
        lengths = scratch.actuator_length[self._own] + self._interval_s * speeds
        at_rest = bias.at_zero + bias.by_length * lengths + bias.by_velocity * speeds
        return at_rest * self._gear

    def _of_muscles(self, scratch: mujoco.MjData) -> tuple[FloatArray, FloatArray]:
        """Return the torque of each muscle's activation, and what all muscles of its hinge give at rest."""
        torques = []
        for level in (1.0, 0.0):
            scratch.act[:] = level
            mujoco.mj_fwdActuation(self._model, scratch)
            torques.append(scratch.actuator_force[self._own] * self._gear)
        at_rest = np.asarray(np.bincount(self._slot, torques[1], self._count), np.float64)
        return torques[0] - torques[1], at_rest[self._slot]


def _divided(torques_nm: FloatArray, full_nm: FloatArray, able: npt.NDArray[np.bool_]) -> FloatArray:
    """Return the activations that give torques; zero where there is no power."""
    return np.divide(torques_nm, full_nm, out=np.zeros_like(full_nm), where=able)


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
    inertia_kgm2 = np.array(
        [_inertia(infant, data, joint, slot not in loose) for slot, joint in enumerate(infant.joints)]
    )
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
        self._motors = DelayedMotors(infant, interval_s)
        self._loads = _loads(infant)

    def __call__(self, data: mujoco.MjData, target_rad: FloatArray) -> FloatArray:
        """Return the controls, (nu,), for angles of all driven hinges, (n,), after a physics step; others' stay."""
        torques_nm = self._torques(data, target_rad)
        dofs = self._infant.dofs
        speeds = data.qvel.take(dofs) + self._interval_s * self._acceleration[0].take(dofs)
        controls = data.ctrl.copy()
        controls[self._infant.actuators] = self._motors.controls(self._scratch, data.act, torques_nm, speeds)
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
        wanted = (
            gains.stiffness_nm * (target_rad - ahead)
            - gains.damping_nms * speeds
            + (-np.asarray(carried_nm, np.float64))
        )
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
    model, slots = infant.model, {int(joint): slot for slot, joint in enumerate(infant.joints)}
    loads = [(joint, slot, 1.0) for joint, slot in slots.items()]
    for start, count in zip(model.tendon_adr, model.tendon_num, strict=True):
        wraps = slice(start, start + count)
        if (model.wrap_type[wraps] != mujoco.mjtWrap.mjWRAP_JOINT).any():
            continue  # It is the ribbon of an object.
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


@dataclass(frozen=True, slots=True)
class LateGroup:
    """Those of the commanded actuators whose commands have one delay."""

    begin: int  # The physics step from now in which a command sent now begins to act.
    end: int  # The one in which the next begins to.
    commands: IntArray  # Indices among all m commands.
    actuators: IntArray  # Indices in the model.


class LateCommands:
    """The commands that were sent to m actuators and do not act yet.

    A command is kept for a control step, and acts after the delay of its own actuator:

        arms  |-- delay --|==== sent now ====|
        legs  |-------- delay --------|==== sent now ====|
             now                          time ->
    """

    def __init__(self, model: mujoco.MjModel, actuators: IntArray, timing: Timing):
        moved = model.jnt_bodyid[model.actuator_trnid[actuators, 0]]
        self.control_steps = timing.period
        self.delay_steps = timing.delay_steps(MOTOR, within(model, moved), len(actuators))
        """Physics steps after which commands act, shape (m,)."""
        self.groups = dict[int, LateGroup]()
        """By the physics step in which they begin, the earliest first."""
        for delay in np.unique(self.delay_steps).tolist():
            which = np.flatnonzero(self.delay_steps == delay).astype(np.intp)
            self.groups[delay] = LateGroup(delay, delay + self.control_steps, which, actuators[which])
        self.last = max(self.groups, default=0)
        """The longest delay."""
        self._sent: deque[FloatArray] = deque(maxlen=self.last // self.control_steps + 1)

    def send(self, commands: FloatArray) -> None:
        """Add the commands of a control step, shape (m,)."""
        self._sent.append(commands)

    def hold(self, commands: FloatArray) -> None:
        """Take commands, shape (m,), to be all that is on its way."""
        self._sent.extend([commands] * (self._sent.maxlen or 0))

    def forget(self) -> None:
        """Begin an episode, in which actuators keep their controls until the first command acts."""
        self._sent.clear()

    def arrive(self, group: LateGroup, step: int, controls: FloatArray) -> None:
        """Write commands into controls, shape (nu,), if some of a group, sent before now, begin to act in a step."""
        ago, since = divmod(group.begin - step, self.control_steps)  # In control steps, and in physics steps.
        if step and since:
            return  # It acts already.
        ago += since > 0
        if ago <= len(self._sent):
            controls[group.actuators] = self._sent[-ago][group.commands]


Propose = Callable[[mujoco.MjData, IntArray], FloatArray]
"""From a state with all that is derived from it, and some of the driven hinges, to the angle that each hinge is to go
to, shape (n,); those of hinges that were not asked for are not used."""


class Rehearsal:
    """Finds the commands of a control step with a forward model, for each joint over its own delay.

    In a copy of the state, each actuator first obeys the commands that were sent to it before, and the controller from
    when a command sent now acts (`LateCommands`). The mean of what the controller does in the control step that begins
    then is sent; what it does of the arms after that is not sent, but predicted for the legs, whose delay is longer.

    So a posture is held as well with control steps of 20 ms as with one command for each physics step, and the delay of
    the legs makes no arm act too early or too late.
    """

    def __init__(self, infant: DrivenInfant, gains: Servo, actuators: IntArray, timing: Timing):
        """Prepare a copy of the infant and its world; actuators but the m given ones keep their controls."""
        model = infant.model
        self._model, self._ahead, self._actuators = model, mujoco.MjData(model), actuators
        self._control = Controller(infant, gains, model.opt.timestep)
        self._late = LateCommands(model, actuators, timing)
        self._all_hinges = np.arange(len(infant.joints))
        self._hinges = infant.slots_of(actuators)
        is_halved = model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4
        self._finish_step = mujoco.mj_step2 if is_halved else mujoco.mj_step
        """Makes a physics step from where all but new controls has been computed."""

    @property
    def delay_steps(self) -> IntArray:
        """Physics steps after which commands act, shape (m,)."""
        return self._late.delay_steps

    def hold(self, data: mujoco.MjData, target_rad: FloatArray) -> FloatArray:
        """Return the commands that keep hinges at angles, shape (m,), and take them to be on their way already."""
        ahead = self._copied(data)
        mujoco.mj_forward(self._model, ahead)
        held = self._control(ahead, target_rad)[self._actuators]
        self._late.hold(held)
        return held

    def __call__(self, data: mujoco.MjData, propose: Propose) -> FloatArray:
        """Return the commands to send now, shape (m,).

        *propose*, which says where hinges go, is asked once for each delay, in the state in which the commands with
        that delay begin to act: the first time for all hinges, later for those alone.
        """
        ahead, late, total = self._copied(data), self._late, np.zeros(len(self._actuators))
        advance, target_rad = mujoco.mj_step, np.empty(0)
        for step in range(late.last + late.control_steps):
            if step:
                advance(self._model, ahead)
                advance = mujoco.mj_step
            if beginning := late.groups.get(step):
                advance, hinges = self._finish_step, self._hinges[beginning.commands]
                mujoco.mj_forward(self._model, ahead)
                if target_rad.size:
                    target_rad[hinges] = propose(ahead, hinges)[hinges]
                else:
                    target_rad = propose(ahead, self._all_hinges).copy()
            controls = self._control(ahead, target_rad) if target_rad.size else ahead.ctrl
            for group in late.groups.values():
                if step < group.begin:
                    late.arrive(group, step, ahead.ctrl)
                    continue
                ahead.ctrl[group.actuators] = controls[group.actuators]
                if step < group.end:
                    total[group.commands] += controls[group.actuators]
        late.send(commands := total / late.control_steps)
        return commands

    def _copied(self, data: mujoco.MjData) -> mujoco.MjData:
        ahead = self._ahead
        ahead.qpos[:], ahead.qvel[:], ahead.act[:] = data.qpos, data.qvel, data.act
        ahead.ctrl[:], ahead.qacc_warmstart[:] = data.ctrl, data.qacc_warmstart
        return ahead

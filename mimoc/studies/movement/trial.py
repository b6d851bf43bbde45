"""What a trial of movement does with an infant: it asks single joints for a share of their strength, and measures.

In every actuation model, all other joints are left quiet. A motor's control, and the activation of the muscle that
pulls the wanted way, is the share itself, through the filter of its activation. So a share is one of the torque limit
in the stronger direction, and the weaker direction gives its own limit at most. Of a servo, the control is found that
makes it give as much at the end of the coming physics step, beside its muscle tone: left alone, it would hold its joint
stiffly instead of leaving it quiet. All of its strength is asked for by the end of its range.
"""

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import mujoco
import numpy as np

from mimoc.base.quantities import Quantity
from mimoc.bundle.model import in_subtrees
from mimoc.policies.control.actuators import ActuatorInverse
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones.trial import Conditions, TrialInfant, compile_at, slackened

SUPINE_DEG = -90.0
CURLED_DEG: Mapping[str, float] = {  # The posture in which an infant is laid on its back, before it settles.
    "{side}_hip1": -60.0,
    "{side}_knee": -90.0,
    "{side}_elbow": -90.0,
    "{side}_shoulder_ad_ab": 60.0,
}
Shares = Mapping[str, float]
"""Share of the strength of some hinges, named without `robot:`; above 0 is towards positive angles."""
QUIET: Shares = {}  # No joint is asked for anything; what tone there is without commands stays.


class Drive:
    """Turns shares of strength into controls."""

    def __init__(self, infant: TrialInfant):
        model = infant.model
        self._infant = infant
        self._slots = np.searchsorted(infant.joints, model.actuator_trnid[:, 0])
        self._gear = model.actuator_gear[:, 0].copy()
        self._muscles = _muscles(model)
        self._limits = (model.actuator_forcerange * self._gear[:, None]).T
        bias = infant.toneless_bias
        self._servos = None if bias is None else ActuatorInverse(infant, infant.actuators, model.opt.timestep, bias)
        self._scratch = mujoco.MjData(model)

    def __call__(self, data: mujoco.MjData, shares: Shares) -> FloatArray:
        """Return the controls, shape (nu,), in a state, for shares of the strength of some hinges, without `robot:`.

        Above 0 is towards positive angles. All other hinges are quiet; those that this infant lacks are left out.
        """
        by_joint = np.array([shares.get(name, 0.0) for name in self._infant.joint_names])
        return self.controls(data, by_joint)

    def controls(self, data: mujoco.MjData, shares: FloatArray) -> FloatArray:
        """Return the same for a share of each driven hinge, shape (n,)."""
        if self._servos:
            return self._of_servos(self._servos, data, shares)
        wanted = shares[self._slots]
        # A muscle pulls against the sign of its gear: its force shortens it.
        wanted = np.where(self._muscles, np.maximum(-np.sign(self._gear) * wanted, 0.0), wanted)
        return np.clip(wanted, *self._infant.model.actuator_ctrlrange.T)

    def _of_servos(self, servos: ActuatorInverse, data: mujoco.MjData, shares: FloatArray) -> FloatArray:
        infant = self._infant
        peaks_nm = np.abs(self._limits).max(axis=0)
        torques_nm = np.zeros(len(shares))
        lengths = self._gear * data.qpos[infant.angles][self._slots]
        bias = infant.model.actuator_biasprm - servos.biases
        tone_nm = self._gear * (bias[:, 0] + bias[:, 1] * lengths)
        torques_nm[self._slots] = np.clip(shares[self._slots] * peaks_nm, *self._limits)
        acting_nm = np.zeros(len(shares))
        acting_nm[self._slots] = np.clip(torques_nm[self._slots] + tone_nm, *self._limits)
        soon_rad_s = self._speeds_soon(data, acting_nm)
        self._scratch.actuator_length[:] = lengths
        controls = servos.controls(self._scratch, data.act, torques_nm, soon_rad_s[infant.dofs])
        wanted = shares[self._slots]
        return np.where(np.abs(wanted) >= 1.0, np.sign(wanted), controls)

    def _speeds_soon(self, data: mujoco.MjData, torques_nm: FloatArray) -> FloatArray:
        """Return the speeds, shape (nv,), after a step with torques at the driven hinges: servos damp those."""
        model, scratch = self._infant.model, self._scratch
        scratch.qpos[:], scratch.qvel[:] = data.qpos, data.qvel
        mujoco.mj_fwdPosition(model, scratch)
        mujoco.mj_fwdVelocity(model, scratch)
        force = scratch.qfrc_passive + data.qfrc_constraint - scratch.qfrc_bias
        acceleration = np.zeros((1, model.nv))
        force[self._infant.dofs] += torques_nm
        mujoco.mj_solveM(model, scratch, acceleration, force[None])
        return data.qvel + model.opt.timestep * acceleration[0]


def slack(infant: TrialInfant) -> TrialInfant:
    """Return an infant whose motors and servos give nothing, and whose muscles are at rest.

    Muscles resist being stretched as before; a muscle tone that is a spring of joints stays (see `Subject.slack`).
    """
    model = copy.copy(infant.model)
    muscles = _muscles(model)
    model.actuator_gainprm[~muscles], model.actuator_biasprm[~muscles] = 0.0, 0.0
    model.actuator_ctrlrange[muscles, 0] = 0.0
    return replace(infant, model=model)


def floating(infant: TrialInfant) -> TrialInfant:
    """Return an infant that touches nothing, itself included."""
    model = copy.copy(infant.model)
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    return replace(infant, model=model)


def all_but(infant: TrialInfant, *joints: str) -> TrialInfant:
    """Return an infant held by an apparatus that leaves only some hinges free."""
    free = {int(infant.model.joint(f"robot:{name}").dofadr[0]) for name in joints if has_joint(infant, name)}
    return infant.fixed([dof for dof in range(infant.model.nv) if dof not in free])


def has_joint(infant: TrialInfant, name: str) -> bool:
    """Return whether an infant has a hinge, named without `robot:`."""
    return mujoco.mj_name2id(infant.model, mujoco.mjtObj.mjOBJ_JOINT, f"robot:{name}") >= 0


def settled(infant: TrialInfant, seconds: float = 3.0) -> mujoco.MjData:
    """Return an infant that was laid on its back, legs and arms bent, and left quiet for a while."""
    data = infant.placed(SUPINE_DEG, CURLED_DEG)
    run(infant, data, seconds, QUIET)
    return data


def driven(
    infant: TrialInfant, data: mujoco.MjData, seconds: float, shares: Shares | Callable[[float], Shares]
) -> Iterator[float]:
    """Drive an infant with shares of its strength, perhaps by the time; yield the time after each physics step."""
    drive, step_s = Drive(infant), infant.model.opt.timestep
    for step in range(round(seconds / step_s)):
        data.ctrl[:] = drive(data, shares(step * step_s) if callable(shares) else shares)
        mujoco.mj_step(infant.model, data)
        yield (step + 1) * step_s


def run(infant: TrialInfant, data: mujoco.MjData, seconds: float, shares: Shares) -> None:
    """Let time pass with the same shares of strength all along."""
    for _ in driven(infant, data, seconds, shares):
        pass


def again(infant: TrialInfant, start: mujoco.MjData, *, moving: bool = True) -> mujoco.MjData:
    """Return a copy of a state in the model of an infant, at rest if it is not *moving*."""
    data = mujoco.MjData(infant.model)
    data.qpos[:], data.act[:] = start.qpos, start.act
    if moving:
        data.qvel[:] = start.qvel
    mujoco.mj_forward(infant.model, data)
    return data


def angle_deg(infant: TrialInfant, data: mujoco.MjData, joint: str) -> float:
    """Return the angle of a hinge, named without `robot:`."""
    return float(np.degrees(data.qpos[infant.model.joint(f"robot:{joint}").qposadr[0]]))


def hinges_below(infant: TrialInfant, body: str) -> IntArray:
    """Return the hinges of a body part and of all that hangs on it."""
    model = infant.model
    below = in_subtrees(model, [model.body(body).id])
    return np.flatnonzero(below[model.jnt_bodyid] & (model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE)).astype(np.intp)


def _muscles(model: mujoco.MjModel) -> np.ndarray:
    return np.asarray(model.actuator_gaintype == mujoco.mjtGain.mjGAIN_MUSCLE)


Values = Mapping[str, float | None]
"""What was measured, by the name of the measure; None if it did not happen, as a kick that never gets far enough."""


@dataclass(frozen=True)
class Subject:
    """An infant of some age, and the spec that it was compiled from."""

    infant: TrialInfant
    spec: InfantSpec  # At its age, for trials that add something to its world.

    @property
    def slack(self) -> TrialInfant:
        """The infant without any activity, muscle tone included: its joints have their passive properties alone."""
        return slack(compile_at(slackened(self.spec), self.spec.age_months, Conditions()))


@dataclass(frozen=True)
class MovementTrial:
    """Something that is done with an infant, as an experiment in physics."""

    name: str
    title: str
    measure: Callable[[Subject], Values] = field(repr=False)
    ages_months: Sequence[float]  # The ages at which it is done unless others are asked for.
    measures: tuple[Quantity, ...]  # What it gives, in the order in which tables show it.
    needs: tuple[str, ...] = ()  # The bodies without which it cannot be tried.
    needs_one_of: tuple[str, ...] = ()
    """Bodies of which one is needed, as hands of different kinds have different fingers; none if there are none."""
    held_out: bool = False
    """Whether nothing of the law `maturing` was chosen with it in view, so that what it gives are predictions."""
    on_request: bool = False  # Whether it takes minutes, so that it is done only if it is asked for by its name.
    side: str = ""  # The side whose limb is measured, `left` or `right`; none if it is about both.


def missing(trial: MovementTrial, infant: TrialInfant) -> str:
    """Return in words what an infant lacks for a trial; nothing if it lacks nothing."""
    lacking = [body for body in trial.needs if not infant.has(body)]
    if trial.needs_one_of and not any(map(infant.has, trial.needs_one_of)):
        lacking.append(" nor ".join(trial.needs_one_of))
    return f"this infant has no {' and no '.join(lacking)}" if lacking else ""

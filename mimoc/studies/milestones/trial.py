"""A trial: attempts of an infant at something, simulated until they fail or succeed, with control across delays.

The infant's senses tell of the past, and its commands wait on their way to the muscles. From what was sensed, the
present state is estimated by the commands that have acted since (`Estimator`), and from there on, the control step in
which a command sent now acts is simulated (`Rehearsal`), each signal over its own delay. This forward model is exact
but for pushes, which nobody announces: the infant learns of them after the delay of its senses.
"""

import copy
from collections import deque
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import mujoco
import numpy as np

from mimoc.compiler.child import child_of
from mimoc.compiler.measuring import compile_infant
from mimoc.compiler.presets import delays
from mimoc.compiler.variants import at_age, errors_at
from mimoc.policies.control.holding import Controller, Rehearsal, servo
from mimoc.policies.control.infant import DrivenInfant
from mimoc.runtime.delays import Timing, delays_by_signal, within
from mimoc.runtime.noise import NoiseStreams
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import PAIRED_GROUPS, STRENGTH_GROUPS
from mimoc.studies.comparison import Basis

FIXED_ARMATURE = 1e6
"""Armature of degrees of freedom that an apparatus holds, in [kg] and [kg m²]: a million times an infant's own."""

INTERVAL_MS = 5.0  # How often commands are sent in trials with delays.


@dataclass(frozen=True, slots=True)
class Conditions:
    """What can be varied to see how much a result hangs on it."""

    push: float = 0.03  # Size of the pushes while sitting and standing, in body weights.
    servo: float = 1.0  # Factor on the natural frequency of the controller.
    strength: float = 1.0  # Factor on the torque limits of all motors, on top of the infant's own.
    delays: bool = False
    """Whether the infant's own delays of senses and commands apply, with a forward model that predicts over them."""


@dataclass(frozen=True)
class TrialInfant(DrivenInfant):
    """A driven infant with what a trial has to know of it, which an apparatus can hold."""

    timing: Timing  # When its senses tell and its commands act, in trials with delays.
    toneless_bias: FloatArray | None = None
    """Bias parameters of servos without muscle tone, shape (nu, mjNBIAS): what their commands alone make of them; None
    if it has no servos."""

    @property
    def sensed_steps(self) -> IntArray:
        """Physics steps after which each joint is known, the root by proprioception and balance, shape (njnt,)."""
        model, timing = self.model, self.timing
        steps = timing.delay_steps("proprioception", within(model, model.jnt_bodyid.astype(np.intp)), model.njnt)
        balance = timing.delay_steps("vestibular", None, model.njnt)
        return np.where(model.jnt_type == mujoco.mjtJoint.mjJNT_FREE, np.maximum(steps, balance), steps)

    def fixed(self, dofs: Collection[int]) -> "TrialInfant":
        """Return an infant some of whose degrees of freedom are held by an apparatus."""
        held = copy.copy(self.model)
        held.dof_armature[list(dofs)] = FIXED_ARMATURE
        return replace(self, model=held)

    def trunk_dofs(self) -> list[int]:
        """Return the degrees of freedom of hip, three of translation and three of rotation, and trunk, without head."""
        return [*range(6), *self.dofs_of("lower_body", "upper_body", "chest")]

    def dofs_of(self, *bodies: str) -> list[int]:
        """Return the degrees of freedom of some bodies relative to their parents."""
        ids = [self.model.body(name).id for name in bodies if self.has(name)]
        return np.flatnonzero(np.isin(self.model.dof_bodyid, ids)).tolist()


def compile_at(spec: InfantSpec, age_months: float, conditions: Conditions) -> TrialInfant:
    """Return the infant of a spec at some age, alone on a flat floor all muscles at its command, or a SpecError."""
    grown = grown_to(spec, age_months, conditions)
    with errors_at(spec, age_months):
        model = compile_infant(grown)
    return in_trial(model, grown)


def in_trial(model: mujoco.MjModel, spec: InfantSpec) -> TrialInfant:
    """Return the infant of a model that was compiled from some spec, perhaps with other things in its world."""
    joints = np.unique(model.actuator_trnid[:, 0]).astype(np.intp)
    bias = compile_infant(_with_actuation(spec, arousal=0.0)).actuator_biasprm if _has_servos(spec) else None
    return TrialInfant(model, joints, own_timing(spec), bias)


def slackened(spec: InfantSpec) -> InfantSpec:
    """Return a spec whose infant has relaxed joints and nothing else: no tone, no dampers of servos."""
    return _with_actuation(spec, arousal=0.0, **({"model": "torque"} if _has_servos(spec) else {}))


def _with_actuation(spec: InfantSpec, **changes: object) -> InfantSpec:
    return spec.model_copy(update={"actuation": spec.actuation.model_copy(update=changes)})


@lru_cache(maxsize=64)
def compile_once(spec: str, age_months: float, conditions: Conditions) -> TrialInfant:
    """Return the infant of a spec in JSON, compiled once by each process; specs themselves cannot be hashed."""
    return compile_at(InfantSpec.model_validate_json(spec), age_months, conditions)


def grown_to(spec: InfantSpec, age_months: float, conditions: Conditions) -> InfantSpec:
    """Return a spec at some age, all muscles at its command with the strength of conditions; or raise a SpecError."""
    asked = spec.actuation
    pairs = {side: pair for pair, sides in PAIRED_GROUPS.items() for side in sides}
    strength = {
        group: conditions.strength * asked.strength.get(group, asked.strength.get(pairs.get(group, group), 1.0))
        for group in STRENGTH_GROUPS
        if group not in PAIRED_GROUPS
    }
    actuation = asked.model_copy(update={"strength": strength, "regions": None, "locked": ()})
    with errors_at(spec, age_months):
        return at_age(spec, age_months, checked=False).model_copy(update={"actuation": actuation})


def _has_servos(spec: InfantSpec) -> bool:
    return spec.actuation.model == "position"


def own_timing(spec: InfantSpec) -> Timing:
    """Return the time base of a spec's infant with its own delays; if it asks for none, with those of its age."""
    asked, timestep_ms = spec.delays, spec.control.timestep_ms
    if asked.preset == "none":
        asked = asked.model_copy(update={"preset": "physiological"})
    entry = delays(spec.model_copy(update={"delays": asked}), child_of(spec).tree)
    step_ms = max(round(INTERVAL_MS / timestep_ms), 1) * timestep_ms
    return Timing(step_ms, timestep_ms, delays_by_signal(entry), entry.legs)


class Estimator:
    """Tells the present state from what the senses told of each joint, after its own delay.

    From the state of the longest delay ago, a copy is simulated under the commands that have acted since; what was
    sensed later replaces its part on the way.
    """

    def __init__(self, model: mujoco.MjModel, sensed_steps: IntArray):
        """Begin without a past; place and speed of each joint are known after *sensed_steps*, shape (njnt,)."""
        self._model, self._estimate = model, mujoco.MjData(model)
        of_speeds = sensed_steps[model.dof_jntid]
        ends = [*model.jnt_qposadr[1:].tolist(), model.nq]
        of_places = np.repeat(sensed_steps, np.array(ends) - model.jnt_qposadr)
        self._parts = {late: (of_places == late, of_speeds == late) for late in np.unique(sensed_steps).tolist()}
        self._past: deque[tuple[FloatArray, ...]] = deque(maxlen=max(self._parts) + 1)

    def __call__(self, data: mujoco.MjData) -> mujoco.MjData:
        """Return the estimate of a state, which the infant knows of later: its controls are those that act until now.

        It is to be called after each physics step, before the next controls.
        """
        estimate, past = self._estimate, self._past
        past.append((data.qpos.copy(), data.qvel.copy(), data.act.copy(), data.ctrl.copy()))
        estimate.qpos[:], estimate.qvel[:], estimate.act[:], estimate.ctrl[:] = past[0]
        for late in range(len(past) - 2, -1, -1):
            qpos, qvel, _, estimate.ctrl[:] = past[-1 - late]
            mujoco.mj_step(self._model, estimate)
            if late in self._parts:
                places, speeds = self._parts[late]
                estimate.qpos[places], estimate.qvel[speeds] = qpos[places], qvel[speeds]
        return estimate


CHECKED_EVERY_S = 0.05  # How often the condition of a trial is checked.

Check = Callable[[mujoco.MjData], str]
"""Returns why a state does not meet the condition of a trial; nothing if it does."""
Target = Callable[[mujoco.MjData, float], FloatArray]
"""Returns the angles that the driven hinges go to, shape (n,), in a state and after a time in [s]."""
Apparatus = Callable[[mujoco.MjData, float], None]  # Moves what an apparatus moves, after a time in [s].
Watch = Callable[[mujoco.MjData], None]  # Sees the state after every physics step, for pictures and measurements.


@dataclass(frozen=True)
class Push:
    """A short force on the chest."""

    start_s: float
    direction: tuple[float, float, float]
    duration_s: float = 0.2


PUSHES = (  # Forward, back and to both sides, far enough apart to come to rest in between.
    Push(2.0, (1.0, 0.0, 0.0)),
    Push(4.0, (-1.0, 0.0, 0.0)),
    Push(6.0, (0.0, 1.0, 0.0)),
    Push(8.0, (0.0, -1.0, 0.0)),
)


@dataclass(frozen=True)
class Attempt:
    """One way to try: a posture to start from, what to go for, and what must be true from when on."""

    infant: TrialInfant  # The infant, with what an apparatus holds of it fixed.
    start: mujoco.MjData
    seconds: float
    check: Check
    checked_from_s: float = 0.0
    goal_deg: Mapping[str, float] = field(default_factory=dict)
    """Joints that leave the posture of the start, which all others keep, and where they go to."""
    target: Target | None = None  # Where the driven hinges go to, if that depends on state or time.
    pushes: Sequence[Push] = ()
    apparatus: Apparatus | None = None
    strategy: str = ""  # In words, which posture it is.
    side: str = ""  # The side that the attempt is about, `left` or `right`, if the trial has sides.


@dataclass(frozen=True, slots=True)
class Outcome:
    """How an attempt ended."""

    success: bool
    seconds: float  # Time at which it failed, or its duration.
    reason: str = ""  # Why it failed.
    strategy: str = ""


@dataclass(frozen=True)
class Trial:
    """Something that infants learn to do, as an experiment in physics."""

    name: str
    title: str
    attempts: Callable[[TrialInfant], Iterable[Attempt]] = field(repr=False)
    """The ways to try it, which an infant tries in turn until one succeeds."""
    needs: tuple[str, ...] = ()  # The bodies without which it cannot be tried.
    basis: Basis = "predicted"
    """Whether a number of the law `maturing` was chosen for the age at which infants succeed."""
    sided: bool = False
    """Whether each attempt is about one side, so that a child can succeed with one and fail with the other."""


def try_out(trial: Trial, infant: TrialInfant, conditions: Conditions, side: str = "") -> Outcome:
    """Return the outcome of the first attempt, of one *side* or either, that succeeds, or of the longest."""
    best = Outcome(False, 0.0, "this infant lacks a part that the trial needs")
    for attempt in trial.attempts(infant) if infant.has(*trial.needs) else ():
        if side not in ("", attempt.side):
            continue
        outcome = simulate(attempt, conditions)
        if outcome.success:
            return outcome
        best = max(best, outcome, key=lambda tried: tried.seconds)
    return best


def simulate(attempt: Attempt, conditions: Conditions, watch: Watch | None = None) -> Outcome:
    """Return the outcome of an attempt."""
    model = attempt.infant.model
    data = mujoco.MjData(attempt.infant.model)
    data.qpos[:] = attempt.start.qpos
    mujoco.mj_forward(model, data)
    controls = _controls(attempt, conditions, data)
    step_s, chest = model.opt.timestep, attempt.infant.pushed
    checked_every = max(round(CHECKED_EVERY_S / step_s), 1)
    for step in range(round(attempt.seconds / step_s)):
        time_s = step * step_s
        if attempt.apparatus:
            attempt.apparatus(data, time_s)
        now = [push for push in attempt.pushes if push.start_s <= time_s < push.start_s + push.duration_s]
        size_n = conditions.push * attempt.infant.weight_n
        data.xfrc_applied[chest, :3] = size_n * np.sum([push.direction for push in now], axis=0) if now else np.zeros(3)
        data.ctrl[:] = controls(step)
        mujoco.mj_step(model, data)
        if watch:
            watch(data)
        checked = step % checked_every == 0 and time_s >= attempt.checked_from_s
        if checked and (reason := attempt.check(data)):
            return Outcome(False, time_s, reason, attempt.strategy)
    return Outcome(True, attempt.seconds, "", attempt.strategy)


def _controls(attempt: Attempt, conditions: Conditions, data: mujoco.MjData) -> Callable[[int], FloatArray]:
    """Return the function from a physics step to the controls that arrive in it, shape (nu,)."""
    infant = attempt.infant
    angles = attempt.infant.turned(attempt.start, attempt.goal_deg)
    target = attempt.target or (lambda data, time_s: angles)
    gains = servo(infant, data, conditions.servo)
    step_s = infant.model.opt.timestep
    if not conditions.delays:
        control = Controller(infant, gains, step_s)
        return lambda step: control(data, target(data, step * step_s))
    model, every = infant.model, infant.timing.period
    actuators = np.arange(model.nu)
    estimator = Estimator(model, infant.sensed_steps)
    rehearsal = Rehearsal(infant, gains, actuators, infant.timing)
    lines = infant.timing.commands(
        within(model, model.jnt_bodyid[model.actuator_trnid[:, 0]]), actuators, NoiseStreams(0)
    )
    arrived = rehearsal.hold(data, target(data, 0.0)).copy()

    def controls(step: int) -> FloatArray:
        estimate = estimator(data)
        if step % every == 0:
            sent = rehearsal(estimate, lambda ahead, _: target(ahead, step * step_s))
            for line in lines:
                line.begin(sent)
        for line in lines:
            if step % every in line.applied_after:
                line.apply(arrived)
        return arrived

    return controls

"""A trial: attempts of an infant at something, simulated until they fail or succeed.

With delays or noise, the infant acts from what its own senses tell (`mimoc.studies.milestones.nerves`); with noise,
each attempt is simulated with several seeds, of which at least half have to succeed. Nobody announces pushes: the
infant learns of them after the delay of its senses. Without both, its body alone is tried, by a controller that knows
all.
"""

import copy
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.compiler.measuring import compile_infant
from mimoc.compiler.variants import at_age, errors_at
from mimoc.policies.control.balance import Balance
from mimoc.policies.control.holding import ESTIMATED_RAD_S, FREQUENCY_RAD_S, Controller, Servo, servo
from mimoc.policies.control.infant import DrivenInfant
from mimoc.runtime.sense import FloatArray
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import PAIRED_GROUPS, STRENGTH_GROUPS
from mimoc.studies.comparison import Basis
from mimoc.studies.milestones.nerves import NervousControl, nerves_of

FIXED_ARMATURE = 1e6
"""Armature of degrees of freedom that an apparatus holds, in [kg] and [kg m²]: a million times an infant's own."""

SEEDS = 3  # Number of seeds with which each attempt of an infant with noise is simulated, of which half succeed.


@dataclass(frozen=True, slots=True)
class Conditions:
    """What can be varied to see how much a result hangs on it."""

    push: float = 0.03  # Size of the pushes while sitting and standing, in body weights.
    servo: float = 1.0  # Factor on the natural frequency of the controller.
    strength: float = 1.0  # Factor on the torque limits of all motors, on top of the infant's own.
    delays: bool = False
    """Whether the infant's own delays of senses and commands apply; without them and noise, its body is tried alone."""
    noise: bool = False
    """Whether its own noise of senses and commands applies."""
    seeds: int = SEEDS
    """Number of seeds with which each attempt is simulated with noise; at least half have to succeed."""

    @property
    def are_of_nerves(self) -> bool:
        """Whether the infant acts from its own senses."""
        return self.delays or self.noise


USUAL = Conditions(delays=True, noise=True)
"""Conditions in which infants are compared with real ones: with a nervous system."""


@dataclass(frozen=True)
class TrialInfant(DrivenInfant):
    """A driven infant with what a trial has to know of it, which an apparatus can hold."""

    toneless_bias: FloatArray | None = None
    """Bias parameters of servos without muscle tone, shape (nu, mjNBIAS): what their commands alone make of them; None
    if it has no servos."""
    nerves: Bundle | None = field(default=None, repr=False)
    """What the runtime is told of its senses, delays and noise; None if its body is tried alone."""

    @property
    def held(self) -> list[int]:
        """The degrees of freedom that an apparatus holds."""
        return np.flatnonzero(self.model.dof_armature >= FIXED_ARMATURE).tolist()

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
        if not conditions.are_of_nerves:
            return in_trial(model, grown)
        nerves = nerves_of(grown, delays=conditions.delays, noise=conditions.noise)
        return replace(in_trial(model, grown), nerves=nerves)


def in_trial(model: mujoco.MjModel, spec: InfantSpec) -> TrialInfant:
    """Return the infant of a model that was compiled from some spec, perhaps with other things in its world."""
    joints = np.unique(model.actuator_trnid[:, 0]).astype(np.intp)
    bias = compile_infant(_with_actuation(spec, arousal=0.0)).actuator_biasprm if _has_servos(spec) else None
    return TrialInfant(model, joints, bias)


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
    balanced: bool = False  # Whether an infant with a nervous system turns its trunk back to how it stood.
    on_feet: bool = False  # Whether its ankles balance it as well.


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
        outcome = _with_seeds(attempt, conditions)
        if outcome.success:
            return outcome
        best = max(best, outcome, key=lambda tried: tried.seconds)
    return best


def _with_seeds(attempt: Attempt, conditions: Conditions) -> Outcome:
    """Return the outcome of the attempt: the first success if at least half of the seeds succeed, or the longest."""
    control = control_of(attempt, conditions)
    seeds = conditions.seeds if conditions.noise else 1
    needed = (seeds + 1) // 2
    succeeded, failed = list[Outcome](), list[Outcome]()
    for seed in range(seeds):
        outcome = simulate(attempt, conditions, seed=seed, control=control)
        (succeeded if outcome.success else failed).append(outcome)
        if len(succeeded) == needed:
            return succeeded[0]
        if len(failed) > seeds - needed:
            break
    return max(failed, key=lambda tried: tried.seconds)


def simulate(
    attempt: Attempt,
    conditions: Conditions,
    watch: Watch | None = None,
    *,
    seed: int = 0,
    control: "Control | None" = None,
) -> Outcome:
    """Return the outcome of an attempt with a seed; *control* is that of the same attempt, if it was tried before."""
    model = attempt.infant.model
    data = mujoco.MjData(attempt.infant.model)
    data.qpos[:] = attempt.start.qpos
    mujoco.mj_forward(model, data)
    control = control or control_of(attempt, conditions)
    control.begin(data, seed)
    step_s, chest = model.opt.timestep, attempt.infant.pushed
    checked_every = max(round(CHECKED_EVERY_S / step_s), 1)
    for step in range(round(attempt.seconds / step_s)):
        time_s = step * step_s
        if attempt.apparatus:
            attempt.apparatus(data, time_s)
        now = [push for push in attempt.pushes if push.start_s <= time_s < push.start_s + push.duration_s]
        size_n = conditions.push * attempt.infant.weight_n
        data.xfrc_applied[chest, :3] = size_n * np.sum([push.direction for push in now], axis=0) if now else np.zeros(3)
        control.before(step, data)
        mujoco.mj_step(model, data)
        control.after(step, data)
        if watch:
            watch(data)
        checked = step % checked_every == 0 and time_s >= attempt.checked_from_s
        if checked and (reason := attempt.check(data)):
            return Outcome(False, time_s, reason, attempt.strategy)
    return Outcome(True, attempt.seconds, "", attempt.strategy)


class BodyControl:
    """Goes to angles knowing the state, without delay or noise."""

    def __init__(self, infant: TrialInfant, gains: Servo, target: Target):
        self._infant, self._gains, self._target = infant, gains, target

    def begin(self, data: mujoco.MjData, seed: int) -> None:
        """Begin in a posture; nothing is random."""
        self._step_s = self._infant.model.opt.timestep
        self._control = Controller(self._infant, self._gains, self._step_s)

    def before(self, step: int, data: mujoco.MjData) -> None:
        """Set the controls of a physics step."""
        data.ctrl[:] = self._control(data, self._target(data, step * self._step_s))

    def after(self, step: int, data: mujoco.MjData) -> None:
        """Do nothing after a physics step."""


Control = BodyControl | NervousControl


def control_of(attempt: Attempt, conditions: Conditions) -> Control:
    """Return what moves an infant in an attempt."""
    infant = attempt.infant
    angles = infant.turned(attempt.start, attempt.goal_deg)
    target = attempt.target or (lambda data, time_s: angles)
    start = mujoco.MjData(infant.model)
    start.qpos[:] = attempt.start.qpos
    mujoco.mj_forward(infant.model, start)
    gains = servo(infant, start, conditions.servo)
    if not conditions.are_of_nerves:
        return BodyControl(infant, gains, target)
    if infant.nerves is None:
        raise ValueError("this infant was compiled for trials of its body alone; compile it with these conditions")
    is_soft = attempt.balanced and not attempt.on_feet  # As behaviours are.
    frequency = ESTIMATED_RAD_S if is_soft else FREQUENCY_RAD_S
    gains = servo(infant, start, conditions.servo, frequency_rad_s=frequency)
    balance = Balance(infant, start, attempt.on_feet) if attempt.balanced else None
    return NervousControl(infant, infant.nerves, start, gains, target, balance, infant.held, attempt.apparatus)

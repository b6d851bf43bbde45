"""An attempt of an infant at something, simulated until it fails or succeeds, with control across delays.

A forward model predicts the state in which a command will take effect.
The infant's senses tell of a past state, and its commands wait on their way to the muscles. From the newest state that
is known, a copy of the model is simulated with the commands that were sent since, up to the moment at which a command
sent now arrives; the controller acts on that prediction. The forward model is exact but for pushes, which nobody
announces: the infant learns of them after the delay of its senses.
"""

from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import mujoco
import numpy as np

from mimoc.control.holding.controller import Controller, servo
from mimoc.senses.sense import FloatArray
from mimoc.studies.certainty import Basis
from mimoc.studies.milestones.infant import Conditions, TrialInfant

INTERVAL_S = 0.005
"""How often a prediction is made and a new command sent; at 20 ms the same infants fall a few months longer."""


class Predictor:
    """Delays states and commands, and predicts over the delays."""

    def __init__(self, model: mujoco.MjModel, delays_s: tuple[float, float], first: FloatArray):
        """Fill the delay lines.

        Args:
            model: The infant and its floor.
            delays_s: Delays of senses and commands.
            first: The controls, shape (nu,), that were sent before the start.
        """
        sensory, self._motor = (round(delay_s / model.opt.timestep) for delay_s in delays_s)
        self._model, self._ahead = model, mujoco.MjData(model)
        self._states: deque[tuple[FloatArray, ...]] = deque(maxlen=sensory + 1)
        self._sent: deque[FloatArray] = deque([first] * (sensory + self._motor + 1), maxlen=sensory + self._motor + 1)

    def sense(self, data: mujoco.MjData) -> None:
        """Take note of the present state, which the infant knows of later."""
        self._states.append((data.qpos.copy(), data.qvel.copy(), data.act.copy()))

    def predict(self) -> mujoco.MjData:
        """Return the state in which a command sent now takes effect, as far as the infant can know."""
        ahead = self._ahead
        ahead.qpos[:], ahead.qvel[:], ahead.act[:] = self._states[0]
        mujoco.mj_forward(self._model, ahead)
        steps = len(self._states) - 1 + self._motor
        for controls in list(self._sent)[len(self._sent) - steps :]:
            ahead.ctrl[:] = controls
            mujoco.mj_step(self._model, ahead)
        return ahead

    def send(self, controls: FloatArray) -> FloatArray:
        """Send controls on their way, and return those that arrive now."""
        self._sent.append(controls)
        return self._sent[-1 - self._motor]


CHECKED_EVERY_S = 0.05
"""How often the condition of a trial is checked."""

Check = Callable[[mujoco.MjData], str]
"""Returns why a state does not meet the condition of a trial; nothing if it does."""
Target = Callable[[mujoco.MjData, float], FloatArray]
"""Returns the angles that the driven hinges go to, shape (n,), in a state and after a time in [s]."""
Apparatus = Callable[[mujoco.MjData, float], None]
"""Moves what an apparatus moves, after a time in [s]."""
Watch = Callable[[mujoco.MjData], None]
"""Sees the state after every physics step, for pictures and measurements."""


@dataclass(frozen=True)
class Push:
    """A short force on the chest."""

    start_s: float
    direction: tuple[float, float, float]
    duration_s: float = 0.2


PUSHES = (
    Push(2.0, (1.0, 0.0, 0.0)),
    Push(4.0, (-1.0, 0.0, 0.0)),
    Push(6.0, (0.0, 1.0, 0.0)),
    Push(8.0, (0.0, -1.0, 0.0)),
)
"""Forward, back and to both sides, far enough apart to come to rest in between."""


@dataclass(frozen=True)
class Attempt:
    """One way to try: a posture to start from, what to go for, and what must be true from when on."""

    infant: TrialInfant
    """The infant, with what an apparatus holds of it fixed."""
    start: mujoco.MjData
    seconds: float
    check: Check
    checked_from_s: float = 0.0
    goal_deg: Mapping[str, float] = field(default_factory=dict)
    """Joints that leave the posture of the start, which all others keep, and where they go to."""
    target: Target | None = None
    """Where the driven hinges go to, if that depends on state or time."""
    pushes: Sequence[Push] = ()
    apparatus: Apparatus | None = None
    strategy: str = ""
    """In words, which posture it is."""
    side: str = ""
    """Of a trial with sides, which one it is about: `left` or `right`."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How an attempt ended."""

    success: bool
    seconds: float
    """Time at which it failed, or its duration."""
    reason: str = ""
    """Why it failed."""
    strategy: str = ""


@dataclass(frozen=True)
class Trial:
    """Something that infants learn to do, as an experiment in physics."""

    name: str
    title: str
    attempts: Callable[[TrialInfant], Iterable[Attempt]] = field(repr=False)
    """The ways to try it, which an infant tries in turn until one succeeds."""
    needs: tuple[str, ...] = ()
    """The bodies without which it cannot be tried."""
    basis: Basis = "predicted"
    """Whether a number of the law `maturing` was chosen for the age at which infants succeed."""
    sided: bool = False
    """Whether each attempt is about one side, so that a child can succeed with one and fail with the other."""


def try_out(trial: Trial, infant: TrialInfant, conditions: Conditions, side: str = "") -> Outcome:
    """Return the outcome of the first attempt that succeeds, or of the one that lasted longest.

    Args:
        trial: The trial.
        infant: Who tries.
        conditions: Under which conditions.
        side: Of a trial with sides, `left` or `right`; none is either.
    """
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
    model, data = attempt.infant.model, mujoco.MjData(attempt.infant.model)
    data.qpos[:] = attempt.start.qpos
    mujoco.mj_forward(model, data)
    controls = _controls(attempt, conditions, data)
    step_s, chest = model.opt.timestep, attempt.infant.pushed
    checked_every = max(round(CHECKED_EVERY_S / step_s), 1)
    for step in range(round(attempt.seconds / step_s)):
        time_s = step * step_s
        if attempt.apparatus:
            attempt.apparatus(data, time_s)
        data.xfrc_applied[chest, :3] = _push_n(attempt, conditions, time_s)
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
    infant, angles = attempt.infant, attempt.infant.turned(attempt.start, attempt.goal_deg)
    target = attempt.target or (lambda data, time_s: angles)
    gains, step_s = servo(infant, data, conditions.servo), infant.model.opt.timestep
    if not conditions.delays:
        control = Controller(infant, gains, step_s)
        return lambda step: control(data, target(data, step * step_s))
    every = max(round(INTERVAL_S / step_s), 1)
    control = Controller(infant, gains, every * step_s)
    sent = control(data, target(data, 0.0))
    predictor = Predictor(infant.model, infant.delays_s, sent)

    def delayed(step: int) -> FloatArray:
        nonlocal sent
        predictor.sense(data)
        if step % every == 0:
            ahead = predictor.predict()
            sent = control(ahead, target(ahead, step * step_s))
        return predictor.send(sent)

    return delayed


def _push_n(attempt: Attempt, conditions: Conditions, time_s: float) -> FloatArray:
    """Return the force on the chest at some time, shape (3,)."""
    now = [push for push in attempt.pushes if push.start_s <= time_s < push.start_s + push.duration_s]
    size_n = conditions.push * attempt.infant.weight_n
    return size_n * np.sum([push.direction for push in now], axis=0) if now else np.zeros(3)

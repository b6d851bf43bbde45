"""An attempt of an infant at something, simulated until it fails or succeeds."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import mujoco
import numpy as np

from mimoc.studies.milestones.controller import Controller, servo
from mimoc.studies.milestones.infant import Conditions, FloatArray, TrialInfant
from mimoc.studies.milestones.predictor import INTERVAL_S, Predictor

CHECKED_EVERY_S = 0.05
"""How often the condition of a trial is checked."""

Check = Callable[[mujoco.MjData], str]
"""Returns why a state does not meet the condition of a trial; nothing if it does."""
Target = Callable[[mujoco.MjData, float], FloatArray]
"""Returns the angles that the driven hinges go to, shape (n,), in a state and after a time in [s]."""
Apparatus = Callable[[mujoco.MjData, float], None]
"""Moves what an apparatus moves, after a time in [s]."""
Watch = Callable[[mujoco.MjModel, mujoco.MjData], None]
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
    start: FloatArray
    """`qpos` at the start."""
    target: Target
    seconds: float
    check: Check
    checked_from_s: float = 0.0
    pushes: Sequence[Push] = ()
    apparatus: Apparatus | None = None
    strategy: str = ""
    """In words, which posture it is."""


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


def try_out(trial: Trial, infant: TrialInfant, conditions: Conditions, watch: Watch | None = None) -> Outcome:
    """Return the outcome of the first attempt that succeeds, or of the one that lasted longest.

    Args:
        trial: What to try.
        infant: Who tries it.
        conditions: Under which conditions.
        watch: Called after every physics step of every attempt.
    """
    best = Outcome(False, 0.0, "this infant lacks a part that the trial needs")
    for attempt in trial.attempts(infant):
        outcome = simulate(attempt, conditions, watch)
        if outcome.success:
            return outcome
        best = max(best, outcome, key=lambda tried: tried.seconds)
    return best


def simulate(attempt: Attempt, conditions: Conditions, watch: Watch | None = None) -> Outcome:
    """Return the outcome of an attempt."""
    model, data = attempt.infant.model, mujoco.MjData(attempt.infant.model)
    data.qpos[:] = attempt.start
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
            watch(model, data)
        checked = step % checked_every == 0 and time_s >= attempt.checked_from_s
        if checked and (reason := attempt.check(data)):
            return Outcome(False, time_s, reason, attempt.strategy)
    return Outcome(True, attempt.seconds, "", attempt.strategy)


def _controls(attempt: Attempt, conditions: Conditions, data: mujoco.MjData) -> Callable[[int], FloatArray]:
    """Return the function from a physics step to the controls that arrive in it, shape (nu,)."""
    infant = attempt.infant
    gains, step_s = servo(infant, data, conditions.servo), infant.model.opt.timestep
    if not conditions.delays:
        control = Controller(infant, gains, step_s)
        return lambda step: control(data, attempt.target(data, step * step_s))
    every = max(round(INTERVAL_S / step_s), 1)
    control = Controller(infant, gains, every * step_s)
    sent = control(data, attempt.target(data, 0.0))
    predictor = Predictor(infant.model, infant.delays_s, sent)

    def delayed(step: int) -> FloatArray:
        nonlocal sent
        predictor.sense(data)
        if step % every == 0:
            ahead = predictor.predict()
            sent = control(ahead, attempt.target(ahead, step * step_s))
        return predictor.send(sent)

    return delayed


def _push_n(attempt: Attempt, conditions: Conditions, time_s: float) -> FloatArray:
    """Return the force on the chest at some time, shape (3,)."""
    now = [push for push in attempt.pushes if push.start_s <= time_s < push.start_s + push.duration_s]
    size_n = conditions.push * attempt.infant.weight_n
    return size_n * np.sum([push.direction for push in now], axis=0) if now else np.zeros(3)


def steady(angles_rad: FloatArray) -> Target:
    """Return the target that keeps to the same angles."""
    return lambda data, time_s: angles_rad

"""Signals on their way: samples of senses to observations, and commands to actuators.

Times and delays are in physics steps. A signal that is sent at s with a delay d arrives at s + d: at a time t, the
latest arrived signal is the last one that was sent by t - d(t). If signals are sent at the times 0, e, 2 e ..., it is
the one with the number floor((t - d(t)) / e). With e = 3 and d = 4:

    t        0   1   2   3   4   5   6   7   8
    sent     0           1           2
    arrived  -   -   -   -   0   0   0   1   1

A delay with jitter m is d + x, where the deviation x is a random walk: in each physics step it grows by 1, shrinks by 1
or stays, with probability 1/3 each, and stays at its bounds -m and m instead of leaving them. All values from -m to m
are equally likely at any time, so that the mean of x is 0 and its standard deviation the root of m (m + 1) / 3. As a
delay never grows faster than time passes, no signal overtakes an earlier one.

`number_arriving`, `first_deviation` and `next_deviation` are these laws, for numbers of Python and for arrays of any
library. The classes of this module serve one infant on the CPU and keep references to samples and commands: 0.1 us for
each, where arrays take 20. `mimoc.runtime.device.signals` serves many infants and keeps their numbers in arrays.
"""

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.state_form import check_finite, check_form, checked_list, require
from mimoc.base.units import to_steps
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.runtime.actuation import as_slice
from mimoc.runtime.noise import NoiseStreams
from mimoc.runtime.sense import CustomSense, FloatArray, IntArray, Sample, Sense
from mimoc.schema.senses import MOTOR, DelayEntry, DelaysEntry, NoiseEntry

Mask = npt.NDArray[np.bool_]


def number_arriving(time: Any, delay: Any, every: int) -> Any:
    """Return the number of the latest signal that was sent at least *delay* ago, if one is sent every *every* steps."""
    return (time - delay) // every


def first_deviation(jitter: Any, drawn: Any, whole: Callable[[Any], Any] = int) -> Any:
    """Return a deviation from -jitter to jitter, all equally likely; see `next_deviation`."""
    deviation = whole(drawn * (2 * jitter + 1)) - jitter
    return deviation - (deviation > jitter) * (deviation - jitter)  # Products of 32 bits may round up.


def next_deviation(deviation: Any, jitter: Any, drawn: Any, whole: Callable[[Any], Any] = int) -> Any:
    """Return the deviation of a delay one physics step later.

    Args:
        deviation: The present one.
        jitter: Its largest size.
        drawn: A random number from 0 to less than 1.
        whole: Rounds non-negative numbers down: `int`, or its counterpart for arrays.
    """
    deviation = deviation + whole(3 * drawn) - 1
    return deviation - (deviation > jitter) * (deviation - jitter) - (deviation < -jitter) * (deviation + jitter)


class Delay:
    """The delay of one channel of an infant, in physics steps."""

    def __init__(self, steps: int, jitter: int = 0, streams: NoiseStreams | None = None, channel: str = ""):
        self.steps = steps
        self.jitter = jitter
        self._streams = streams or NoiseStreams(0)
        self._channel = channel
        self.deviation = 0  # The present deviation from its mean.

    def reset(self) -> None:
        """Draw a first deviation."""
        if self.jitter:
            self.deviation = first_deviation(self.jitter, self._streams[self._channel].random())

    def advance(self, physics_steps: int) -> list[int]:
        """Return the delay after each of the next physics steps."""
        if not self.jitter:
            return [self.steps] * physics_steps
        delays = []
        for drawn in self._streams[self._channel].random(physics_steps).tolist():
            self.deviation = next_deviation(self.deviation, self.jitter, drawn)
            delays.append(self.steps + self.deviation)
        return delays


class DelayedSamples:
    """The samples of a sense, or of some of its numbers, on their way to observations.

    A sense is sampled only at times that will be observed: with jitter, the delay of an observation is drawn before the
    earliest time at which its sample could be taken. With control steps of 4 physics steps and a delay of 6:

        time      0       4       8       12
        sampled   |   a   |   b   |   c   |
        observed                  a       b
    """

    def __init__(self, delay: Delay, control_steps: int, part: Mask | None = None):
        """Delay samples, or only the numbers of them in *part*."""
        self.part, self.delay, self._period = part, delay, control_steps
        self.sampled_after: tuple[int, ...] = (control_steps - delay.steps % control_steps,)  # In this control step.

    def reset(self, sample: Sample) -> None:
        """Forget all samples; this one is observed until a later one arrives."""
        self.delay.reset()
        self._taken = deque([sample] * self._room)
        self._planned: list[int] = []

    @property
    def arrived(self) -> Sample:
        """The sample that has arrived."""
        return self._taken[0]

    @property
    def _room(self) -> int:
        """Number of observations whose samples have been taken, the present one included; with jitter, at the start."""
        return 1 if self.delay.jitter else self.delay.steps // self._period + 1

    def begin(self) -> None:
        """Plan when the sense is sampled in the next control step, if its delay varies."""
        while not self._planned or self._planned[-1] <= self._period:
            observed = (len(self._taken) + len(self._planned)) * self._period
            sampled = observed - self.delay.advance(self._period)[-1]
            sampled = max(sampled, self._planned[-1] if self._planned else 0)  # Never before an earlier observation's.
            if sampled > 0:
                self._planned.append(sampled)
            else:
                self._taken.append(self._taken[-1])
        self._taken.popleft()
        self.sampled_after = tuple(sorted({after for after in self._planned if after <= self._period}))
        self._planned = [after - self._period for after in self._planned]  # From the end of this control step on.

    def send(self, sample: Sample) -> None:
        """Take a new sample for each observation that is due."""
        if not self.delay.jitter:
            self._taken.append(sample)
            self._taken.popleft()
            return
        now = self._planned[0]
        while self._planned and self._planned[0] == now:
            self._taken.append(sample)
            del self._planned[0]

    def carry_on(self, former: "DelayedSamples") -> None:
        """Continue with the samples that were on their way with the delay of another age.

        Without jitter, the newest stay on their way, as many as this delay has room for, and the one before them has
        arrived; if there is room for more, the oldest is observed for longer. With jitter, all stay.
        """
        self.state = former.state
        if not self.delay.jitter:
            missing = self._room - len(self._taken)
            self._taken.extendleft([self.arrived] * missing)
            self._taken = deque(list(self._taken)[-self._room :])
            self._planned = []

    @property
    def state(self) -> list[Any]:
        """The samples of the present and later observations, the times of those not taken yet, and the deviation."""
        return [list(self._taken), list(self._planned), self.delay.deviation]

    @state.setter
    def state(self, state: list[Any]) -> None:
        taken, planned, self.delay.deviation = state
        self._taken, self._planned = deque(taken), list(planned)

    def check(self, state: object, where: str) -> None:
        """Check a state; see `check_form`."""
        taken, planned, deviation = checked_list(state, where, 3)
        for sample in checked_list(taken, where, None if self.delay.jitter else self._room):
            check_form(sample, self.arrived, where)
        for after in checked_list(planned, where, None if self.delay.jitter else 0):
            check_form(after, 0, where)
        check_form(deviation, 0, where)
        observed = [(len(taken) + number) * self._period for number in range(len(planned))]
        are_due = all(0 < after <= end for after, end in zip(planned, observed, strict=True))
        require(len(taken) > 0 and are_due and list(planned) == sorted(planned), where, state)


class DelayedCommands:
    """Commands on their way to some actuators.

    In each physics step, the latest of those commands is applied that were sent at least as long ago as the delay is.
    """

    def __init__(self, delay: Delay, control_steps: int, part: IntArray, actuators: IntArray):
        """Delay the commands *part*, shape (n,), to *actuators*, shape (n,)."""
        self.delay, self._period = delay, control_steps
        self.applied_after: tuple[int, ...] = (delay.steps % control_steps,)  # Physics steps of this control step.
        self._part = part
        self._columns = as_slice(part)
        self._actuators = as_slice(actuators)
        self._room = delay.steps // control_steps
        self.state = [[], 0]

    def reset(self) -> None:
        """Forget all commands; the actuators keep their controls until a new one arrives."""
        self.delay.reset()
        self.state = [[], self.delay.deviation]

    def begin(self, controls: FloatArray) -> None:
        """Take the controls of all actuators for the next control step, during which earlier ones arrive."""
        self._sent.append(controls)
        if not self.delay.jitter:
            if len(self._sent) > self._room:
                self._arriving.append(self._sent.popleft())
            return
        applied = list[int]()
        for after, delay in enumerate(self.delay.advance(self._period)):
            kept = -number_arriving(after, delay, self._period)
            if kept < len(self._sent):  # Else the command that has arrived by now was applied before.
                applied.append(after)
                self._arriving.append(self._sent[-1 - kept])
                self._keep(kept)
        self.applied_after = tuple(applied)

    def apply(self, controls: FloatArray) -> None:
        """Write the commands that arrive into the controls of the model, shape (nu,)."""
        if self._arriving:
            controls[self._actuators] = self._arriving.popleft()[self._columns]

    def carry_on(self, former: "DelayedCommands") -> None:
        """Continue with the commands that were on their way with the delay of another age.

        The newest stay on their way, as many as this delay has room for; if there is room for more, actuators keep
        their controls for longer.
        """
        self.state = former.state
        if not self.delay.jitter:
            self._keep(self._room)

    def _keep(self, count: int) -> None:
        while len(self._sent) > count:
            self._sent.popleft()

    @property
    def state(self) -> list[Any]:
        """The controls on their way, and the deviation of the delay."""
        return [list(self._sent), self.delay.deviation]

    @state.setter
    def state(self, state: list[Any]) -> None:
        sent, self.delay.deviation = state
        self._sent: deque[FloatArray] = deque(sent)
        self._arriving: deque[FloatArray] = deque()

    def check(self, state: object, where: str) -> None:
        """Check a state; see `check_form`."""
        sent, deviation = checked_list(state, where, 2)
        require(self.delay.jitter > 0 or len(checked_list(sent, where)) <= self._room, where, sent)
        for controls in checked_list(sent, where):
            check_controls(controls, self._part, where)
        check_form(deviation, 0, where)


def carry_on(groups: Sequence[Any], former: Sequence[Any]) -> None:
    """Let all groups of a signal continue from those of another age."""
    for index, group in enumerate(groups):
        group.carry_on(former[min(index, len(former) - 1)])


def check_controls(controls: Any, part: IntArray, where: str) -> None:
    """Raise a ValueError unless *controls* can be those of all actuators, which include *part*."""
    is_array = isinstance(controls, np.ndarray) and controls.dtype.kind == "f" and controls.ndim == 1
    require(is_array and controls.size > part.max(initial=-1), where, controls)
    check_finite(controls, where)


NO_DELAY, NO_NOISE = DelayEntry(), NoiseEntry()
Within = Callable[[Sequence[str]], Mask]  # Which of n numbers belong to bodies or what hangs on them.


def within(model: mujoco.MjModel, bodies: IntArray) -> Within:
    """Return the function of body parts that tells which numbers, each of one of *bodies*, belong to them."""
    return lambda parts: in_subtrees(model, [model.body(part).id for part in parts])[bodies]


@dataclass(frozen=True, slots=True)
class Timing:
    """The time base of an infant, and the delays of its signals with their jitter; all are whole physics steps."""

    step_ms: float
    timestep_ms: float
    delays: Mapping[str, DelayEntry]  # By sense, and `motor` for commands; a signal without an entry has none.
    legs: Sequence[str] = ()  # Bodies that the legs begin with, to and from which a delay can be longer.
    noise: NoiseEntry = NO_NOISE  # Noise of commands and senses, and jitter of the delays.

    @property
    def period(self) -> int:
        """Physics steps in a control step."""
        return to_steps(self.step_ms, self.timestep_ms)

    def samples(self, sense: str, within: Within | None, streams: NoiseStreams) -> list[DelayedSamples]:
        """Return the delay lines of a sense, one for each delay; *within* is None if it belongs to no body part."""
        return [DelayedSamples(delay, self.period, part) for delay, part in self._of(sense, within, streams)]

    def commands(self, within: Within, actuators: IntArray, streams: NoiseStreams) -> list[DelayedCommands]:
        """Return the delay lines of the commands of n actuators, shape (n,), one for each delay."""
        delayed = list[DelayedCommands]()
        for delay, part in self._of(MOTOR, within, streams):
            which = np.arange(len(actuators)) if part is None else np.flatnonzero(part)
            delayed.append(DelayedCommands(delay, self.period, which, actuators[which]))
        return delayed

    def further_commands(self, first: int, count: int, streams: NoiseStreams) -> list[DelayedCommands]:
        """Return the delay lines of *count* commands from number *first* on, which move no joint."""
        part, numbers = np.arange(first, first + count), np.arange(count)
        return [DelayedCommands(delay, self.period, part, numbers) for delay, _ in self._of(MOTOR, None, streams)]

    def groups(self, signal: str, within: Within | None) -> list[tuple[str, int, Mask | None]]:
        """Return the delays of a signal: name, physics steps, and mask of the numbers with this delay; None is all."""
        delay = self.delays.get(signal, NO_DELAY)
        parts = [(f"{signal}.{part.body}", part.ms, [part.body]) for part in delay.parts]
        if delay.legs_ms is not None:
            parts = [(f"{signal}.legs", delay.legs_ms, self.legs), *parts]
        groups: list[tuple[str, int, Mask | None]] = []
        left: Mask | None = None
        inside_of = [] if within is None else [(name, ms, within(bodies)) for name, ms, bodies in parts]
        for name, ms, mask in reversed(inside_of):  # Later parts are in earlier ones.
            inside = mask if left is None else mask & left
            if inside.any():
                groups.append((name, to_steps(ms, self.timestep_ms), inside))
                left = ~inside if left is None else left & ~inside
        return [(signal, to_steps(delay.ms, self.timestep_ms), left), *reversed(groups)]

    def delay_steps(self, signal: str, within: Within | None, count: int) -> IntArray:
        """Return the delay of each number of a signal in physics steps, shape (count,)."""
        steps = np.zeros(count, np.intp)
        for _, late, part in self.groups(signal, within):
            steps[slice(None) if part is None else part] = late
        return steps

    def jitter(self, delay_steps: int) -> int:
        """Return the largest deviation of a delay in physics steps, at most the delay itself."""
        return min(to_steps(self.noise.delay_jitter_ms, self.timestep_ms), delay_steps)

    def _of(self, signal: str, within: Within | None, streams: NoiseStreams) -> list[tuple[Delay, Mask | None]]:
        return [
            (Delay(late, self.jitter(late), streams, f"jitter.{name}"), part)
            for name, late, part in self.groups(signal, within)
        ]


def delays_by_signal(entry: DelaysEntry) -> Mapping[str, DelayEntry]:
    """Return the delays of a manifest by sense, and under `motor` that of commands."""
    return {name: delay for name, delay in entry if isinstance(delay, DelayEntry)}


def timing_of(manifest: Manifest, senses: Mapping[str, Sense]) -> Timing:
    """Return the timing of an infant, with the delays of senses that a script passes."""
    custom = {name: sense.delay for name, sense in senses.items() if isinstance(sense, CustomSense)}
    delays = {**delays_by_signal(manifest.delays), **custom}
    return Timing(manifest.step_ms, manifest.timestep_ms, delays, manifest.delays.legs, manifest.noise)

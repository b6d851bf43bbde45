"""Signals whose delay varies: the samples of senses, and commands to actuators."""

from collections import deque
from typing import Any

from mimoc.base.random_streams import whole_between
from mimoc.base.state_form import check_form, checked_list, demand
from mimoc.runtime.delays.signals import Mask, check_controls
from mimoc.runtime.noise.noise import NoiseStreams
from mimoc.runtime.sense import FloatArray, IntArray, Sample


class DelayRandomWalk:
    """The deviation of a delay, which grows by a physics step, shrinks by one or stays, each with probability 1/3.

    At the bounds it stays instead of leaving them. All values from -most to most are equally likely at any time, so
    that the mean deviation is 0 and the standard deviation is the root of most (most + 1) / 3. As a delay never grows
    faster than time passes, no signal overtakes an earlier one.
    """

    def __init__(self, most: int, streams: NoiseStreams, channel: str):
        """Wander between -most and most physics steps, by the stream of a channel."""
        self._most, self._streams, self._channel = most, streams, channel
        self.steps = 0
        """The present deviation, in physics steps."""

    def reset(self) -> None:
        """Begin at any value."""
        self.steps = whole_between(self._streams[self._channel], -self._most, self._most)

    def advance(self, physics_steps: int) -> list[int]:
        """Return the deviation after each of some physics steps."""
        deviations = []
        for drawn in self._streams[self._channel].random(physics_steps).tolist():
            self.steps = max(-self._most, min(self._most, self.steps + int(3 * drawn) - 1))
            deviations.append(self.steps)
        return deviations


class JitteredSamples:
    """The samples of a sense, or of some of its numbers, on their way to observations, as `DelayedSamples`.

    The delay of each observation is drawn before the earliest time at which it could be sampled, so that a sense is
    only sampled when it is to be observed.
    """

    def __init__(self, delay_steps: int, control_steps: int, part: Mask | None, wander: DelayRandomWalk):
        """Delay samples by a number of physics steps and its deviation, which is not larger."""
        self.part = part
        self._delay, self._period, self._wander = delay_steps, control_steps, wander
        self.sampled_after: tuple[int, ...] = ()
        """Physics steps of this control step after which the sense is sampled."""

    def reset(self, sample: Sample) -> None:
        """Forget all samples; this one is observed until a later one arrives."""
        self._wander.reset()
        self._now = 0
        self._due: deque[tuple[int, Sample | None]] = deque([(0, sample)])

    @property
    def arrived(self) -> Sample:
        """The sample that has arrived."""
        sample = self._due[0][1]
        assert sample is not None, "the sample of an observation has been taken by then"
        return sample

    def begin(self) -> None:
        """Draw when the sense is sampled in the next control step."""
        start, end = self._now, self._now + self._period
        while self._due[-1][0] <= end:
            observed = start + len(self._due) * self._period
            taken = observed - self._delay - self._wander.advance(self._period)[-1]
            latest, sample = self._due[-1]
            if taken <= latest > 0:  # The delay was shorter until now; what was taken last is observed for longer.
                self._due.append((latest, sample))
            else:
                self._due.append((taken, self.arrived if taken <= 0 else None))
        self._due.popleft()
        self._now = end
        self.sampled_after = tuple(
            sorted({taken - start for taken, sample in self._due if taken <= end and sample is None})
        )

    def send(self, sample: Sample) -> None:
        """Take a new sample, for each observation that is due now."""
        now = next(taken for taken, kept in self._due if kept is None)
        self._due = deque((taken, sample if taken == now else kept) for taken, kept in self._due)

    @property
    def state(self) -> list[Any]:
        """Time and deviation, and when the sample of each observation is taken, with those that have been."""
        return [self._now, self._wander.steps, list(self._due)]

    @state.setter
    def state(self, state: list[Any]) -> None:
        self._now, self._wander.steps, due = state
        self._due = deque(due)

    def check(self, state: object, where: str) -> None:
        """Check that the sample of each observation has been taken if it was due by now; see `check_form`."""
        now, deviation, due = checked_list(state, where, 3)
        check_form([now, deviation], [0, 0], where)
        demand(len(checked_list(due, where)) > 0, where, due)
        for number, (taken, sample) in enumerate(due):
            check_form(taken, 0, where)
            demand(taken <= now + number * self._period and (sample is not None) == (taken <= now), where, due)
            if sample is not None:
                check_form(sample, self.arrived, where)
        demand(due[-1][0] >= now, where, due)


class JitteredCommands:
    """Commands on their way to some actuators, as `DelayedCommands`.

    At each physics step the latest of those commands is applied that were sent at least as long ago as the delay is.
    """

    def __init__(
        self, delay_steps: int, control_steps: int, part: IntArray, actuators: IntArray, wander: DelayRandomWalk
    ):
        """Delay commands by a number of physics steps and its deviation, which is not larger."""
        self._delay, self._period, self._wander = delay_steps, control_steps, wander
        self._part, self._actuators = part, actuators
        self.applied_after: tuple[int, ...] = ()
        """Physics steps of this control step after which commands arrive."""

    def reset(self) -> None:
        """Forget all commands; the actuators keep their controls until a new one arrives."""
        self._wander.reset()
        self._number, self._applied = -1, -1
        self._sent: list[FloatArray] = []
        self._arriving: deque[int] = deque()

    def begin(self, controls: FloatArray) -> None:
        """Take the controls of all actuators for the next control step, and draw which arrive during it, and when."""
        self._number += 1
        self._sent.append(controls)
        start, applied = self._number * self._period, []
        for after, deviation in enumerate(self._wander.advance(self._period)):
            number = (start + after - self._delay - deviation) // self._period
            if number > self._applied:
                applied.append(after)
                self._arriving.append(number)
                self._applied = number
        self.applied_after = tuple(applied)

    def apply(self, controls: FloatArray) -> None:
        """Write the commands that arrive into the controls of the model, shape (nu,)."""
        number = self._arriving.popleft()
        arrived = self._sent[number - self._number - 1]
        controls[self._actuators] = arrived[self._part]
        if not self._arriving:
            del self._sent[: number - self._number - 1 + len(self._sent)]

    @property
    def state(self) -> list[Any]:
        """The number of the last command sent and of the last applied, the deviation, and the commands on their way."""
        return [self._number, self._applied, self._wander.steps, list(self._sent)]

    @state.setter
    def state(self, state: list[Any]) -> None:
        self._number, self._applied, self._wander.steps, sent = state
        self._sent, self._arriving = list(sent), deque()

    def check(self, state: object, where: str) -> None:
        """Check that all commands since the one applied last are there; see `check_form`."""
        number, applied, deviation, sent = checked_list(state, where, 4)
        check_form([number, applied, deviation], [0, 0, 0], where)
        demand(-1 <= applied <= number, where, state)
        for controls in checked_list(sent, where, number - max(applied, 0) + 1):
            check_controls(controls, self._part, where)

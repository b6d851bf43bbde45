"""Signals with a delay: the samples of senses, and commands to actuators."""

from collections import deque
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.state_form import check_finite, check_form, checked_list, demand
from mimoc.runtime.sense import FloatArray, IntArray, Sample

Mask = npt.NDArray[np.bool_]


def check_controls(controls: Any, part: IntArray, where: str) -> None:
    """Raise a ValueError unless it can be the controls of all actuators, of which a part is on its way."""
    is_array = isinstance(controls, np.ndarray) and controls.dtype.kind == "f" and controls.ndim == 1
    demand(is_array and controls.size > part.max(initial=-1), where, controls)
    check_finite(controls, where)


class DelayedSamples:
    """The samples of a sense, or of some of its numbers, on their way to the observation."""

    def __init__(self, delay_steps: int, control_steps: int, part: Mask | None = None):
        """Delay samples by some physics steps, or those numbers of them that are *part*; None is all."""
        self.sampled_after = (control_steps - delay_steps % control_steps,)
        """Physics steps of a control step after which the sense is sampled, to arrive at the end of a control step."""
        self.part = part
        self.length = delay_steps // control_steps
        """Number of samples on their way."""

    def reset(self, sample: Sample) -> None:
        """Forget all samples; this one is observed until a later one arrives."""
        self.arrived = sample
        self._line = deque([sample] * self.length)

    def send(self, sample: Sample) -> None:
        """Take a new sample; an earlier one arrives."""
        self._line.append(sample)
        self.arrived = self._line.popleft()

    @property
    def state(self) -> list[Sample]:
        """The sample that has arrived, then those on their way."""
        return [self.arrived, *self._line]

    @state.setter
    def state(self, samples: list[Sample]) -> None:
        self.arrived, self._line = samples[0], deque(samples[1:])

    def check(self, state: object, where: str) -> None:
        """Check a state; see `check_form`."""
        check_form(state, self.state, where)


class DelayedCommands:
    """Commands on their way to some actuators."""

    def __init__(self, delay_steps: int, control_steps: int, part: IntArray, actuators: IntArray):
        """Delay the commands with some indices, shape (n,), by some physics steps, to these actuators, shape (n,)."""
        self.applied_after = (delay_steps % control_steps,)
        """Physics steps of a control step after which commands arrive."""
        self.length = delay_steps // control_steps
        """Number of commands on their way."""
        self._part, self._columns, self._actuators = part, as_slice(part), as_slice(actuators)
        self.reset()

    def reset(self) -> None:
        """Forget all commands; the actuators keep their controls until a new one arrives."""
        self._line: deque[FloatArray | None] = deque([None] * self.length)

    def begin(self, controls: FloatArray) -> None:
        """Take the controls of all actuators for the next control step; earlier ones arrive during it."""
        self._line.append(controls)
        self._arrived = self._line.popleft()

    def apply(self, controls: FloatArray) -> None:
        """Write the commands that arrive into the controls of the model, shape (nu,)."""
        if self._arrived is not None:
            controls[self._actuators] = self._arrived[self._columns]

    @property
    def state(self) -> list[FloatArray | None]:
        """The controls on their way."""
        return list(self._line)

    @state.setter
    def state(self, controls: list[FloatArray | None]) -> None:
        self._line = deque(controls)

    def check(self, state: object, where: str) -> None:
        """Check a state; see `check_form`."""
        for controls in checked_list(state, where, self.length):
            if controls is not None:
                check_controls(controls, self._part, where)


def as_slice(indices: IntArray) -> IntArray | slice:
    """Return indices that follow each other as a slice, which is read and written faster."""
    first = int(indices[0]) if len(indices) else 0
    return slice(first, first + len(indices)) if (np.diff(indices) == 1).all() else indices

"""Commands on their way to actuators, as a forward model needs them: which of them act in each physics step to come.

A command is kept for a control step, and acts after the delay of its own actuator:

    arms  |-- on their way --|==== sent now ====|
    legs  |-------- on their way --------|==== sent now ====|
         now                          time ->
"""

from collections import deque
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.runtime.delays.timing import Timing, within
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.delays import MOTOR


@dataclass(frozen=True, slots=True)
class LateGroup:
    """Those of the commanded actuators whose commands have one delay."""

    begin: int
    """The physics step from now in which a command sent now begins to act."""
    end: int
    """The one in which the next begins to."""
    commands: IntArray
    """Indices among all m commands."""
    actuators: IntArray
    """Indices in the model."""


class LateCommands:
    """The commands that were sent to m actuators and do not act yet."""

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

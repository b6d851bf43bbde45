"""A forward model: an infant's model, stepped ahead of its state under the commands that are on their way."""

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.runtime.delays import Timing, within
from mimoc.runtime.sense import FloatArray, IntArray
from mimoc.schema.senses import MOTOR

_PARTS = mujoco.mjtState
STATE = int(_PARTS.mjSTATE_INTEGRATION)  # The part of a state that determines all that follows.
OWN_STATE = int(_PARTS.mjSTATE_PHYSICS) | int(_PARTS.mjSTATE_CTRL) | int(_PARTS.mjSTATE_WARMSTART)
"""That part without the forces that others apply, which an infant cannot foresee."""


def copy_state(model: mujoco.MjModel, source: mujoco.MjData, target: mujoco.MjData, part: int = STATE) -> None:
    """Copy a part of a state, without what is derived from it."""
    state = np.empty(mujoco.mj_stateSize(model, part))
    mujoco.mj_getState(model, source, state, part)
    mujoco.mj_setState(model, target, state, part)


@dataclass(frozen=True, slots=True)
class LateGroup:
    """Those of the commanded actuators whose commands have one delay."""

    begin: int  # The physics step from now in which a command sent now begins to act.
    end: int  # The one in which the next begins to.
    commands: IntArray  # Indices among all m commands.
    actuators: IntArray  # Indices in the model.


def late_groups(model: mujoco.MjModel, actuators: IntArray, timing: Timing) -> list[LateGroup]:
    """Return m commanded actuators by the delay of their commands, the shortest first."""
    moved = model.jnt_bodyid[model.actuator_trnid[actuators, 0]]
    delay_steps = timing.delay_steps(MOTOR, within(model, moved), len(actuators))
    groups = list[LateGroup]()
    for delay in np.unique(delay_steps).tolist():
        which = np.flatnonzero(delay_steps == delay).astype(np.intp)
        groups.append(LateGroup(delay, delay + timing.period, which, actuators[which]))
    return groups


class ForwardModel:
    """Foresees the states in which commands act that are sent now to m actuators.

    A command is kept for a control step, and acts after the delay of its own actuator:

        arms  |-- delay --|==== sent now ====|
        legs  |-------- delay --------|==== sent now ====|
             now                          time ->

    Until then, each actuator obeys the commands that were sent to it before.
    """

    def __init__(self, model: mujoco.MjModel, actuators: IntArray, timing: Timing, state: int = STATE):
        """Prepare a copy of the model's state, which takes over *state* of it; other actuators keep their controls."""
        self._model = model
        self._ahead = mujoco.MjData(model)
        self._state = state
        groups = late_groups(model, actuators, timing)
        self.control_steps = timing.period
        """Physics steps in a control step."""
        self.delay_steps = np.zeros(len(actuators), np.intp)
        """Physics steps after which commands act, shape (m,)."""
        for group in groups:
            self.delay_steps[group.commands] = group.begin
        self._groups = {group.begin: group for group in groups}  # By when they begin, the earliest first.
        self.longest = max(self._groups, default=0)
        """The longest delay."""
        self._sent: deque[FloatArray] = deque(maxlen=self.longest // self.control_steps + 1)
        self._advance: Callable[[mujoco.MjModel, mujoco.MjData], None] = mujoco.mj_step

    def send(self, commands: FloatArray) -> None:
        """Add the commands of a control step, shape (m,), to those that are on their way."""
        self._sent.append(commands)

    def hold(self, commands: FloatArray) -> None:
        """Take commands, shape (m,), to be all that is on its way."""
        self._sent.extend([commands] * (self._sent.maxlen or 0))

    def forget(self) -> None:
        """Begin an episode, in which actuators keep their controls until the first command acts."""
        self._sent.clear()

    def copied(self, data: mujoco.MjData) -> mujoco.MjData:
        """Return the copy, with the present state."""
        copy_state(self._model, data, self._ahead, self._state)
        return self._ahead

    def foresee(self, data: mujoco.MjData, steps: int) -> Iterator[tuple[int, mujoco.MjData, LateGroup | None]]:
        """Yield the states before each of the next physics steps, with the group whose commands begin to act there.

        Whoever asks sets the controls of groups that have begun, in the state itself, before going on.
        """
        ahead = self.copied(data)
        for step in range(steps):
            if step:
                self._advance(self._model, ahead)
            self._advance = mujoco.mj_step
            yield step, ahead, self._groups.get(step)
            for group in self._groups.values():
                if step < group.begin:
                    self._arrive(group, step, ahead.ctrl)

    def compute(self) -> None:
        """Compute all that is derived from the state that `foresee` yielded last."""
        mujoco.mj_forward(self._model, self._ahead)
        if self._model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4:
            self._advance = mujoco.mj_step2  # All but new controls has been computed.

    def begun(self, step: int) -> list[LateGroup]:
        """Return the groups in which commands sent now act in a physics step, or have acted before."""
        return [group for group in self._groups.values() if group.begin <= step]

    def _arrive(self, group: LateGroup, step: int, controls: FloatArray) -> None:
        """Write commands into controls, shape (nu,), if some of a group, sent before now, begin to act in a step."""
        ago, since = divmod(group.begin - step, self.control_steps)  # In control steps, and in physics steps.
        if step and since:
            return  # It acts already.
        ago += since > 0
        if ago <= len(self._sent):
            controls[group.actuators] = self._sent[-ago][group.commands]

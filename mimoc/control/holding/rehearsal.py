"""Control of whole control steps by a forward model: what the controller would do in each physics step to come.

A command is kept for a control step, and acts after the delay of its own actuator. In a copy of the state, each
actuator first obeys the commands that are on their way to it, and then, from when a command sent now acts, the
controller. The mean of what the controller does in that control step is sent:

    arms  |-- on their way --|=== mean is sent ===|-- not sent --|
    legs  |-------- on their way --------|=== mean is sent ===|
         now                              time ->

So a posture is held as well with control steps of 20 ms as with one command for each physics step, and what is slow to
reach the legs makes no arm act too early or too late.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.control.holding.controller import Controller, Servo
from mimoc.control.holding.driven import DrivenInfant
from mimoc.delays.spec import MOTOR
from mimoc.delays.timing import Timing, within
from mimoc.senses.sense import FloatArray, IntArray

Propose = Callable[[mujoco.MjData, IntArray], FloatArray]
"""From a state with all that is derived from it, and some of the driven hinges, to the angle that each hinge is to go
to, shape (n,); those of hinges that were not asked for are not used."""


@dataclass(frozen=True, slots=True)
class _Group:
    """Those of the commanded actuators whose commands have one delay."""

    begin: int
    """The physics step from now in which a command sent now begins to act."""
    end: int
    commands: IntArray
    """Indices among all m commands."""
    actuators: IntArray
    """Indices in the model."""
    hinges: IntArray
    """Indices of the driven hinges that they move."""


class Rehearsal:
    """Finds the commands of a control step by looking ahead to when they act, for each joint over its own delay."""

    def __init__(self, infant: DrivenInfant, gains: Servo, actuators: IntArray, timing: Timing):
        """Prepare a copy of the infant and its world.

        Args:
            infant: The infant.
            gains: Stiffness and damping of its joints.
            actuators: Indices of the m actuators that are commanded; all others keep their controls.
            timing: The control step, and the delays of commands.
        """
        model = infant.model
        self._model, self._ahead = model, mujoco.MjData(model)
        self._control = Controller(infant, gains, model.opt.timestep)
        self._actuators, self._control_steps = actuators, timing.period
        driving = model.actuator_trnid[actuators, 0]
        moved = np.searchsorted(infant.joints, driving).astype(np.intp)
        self.delay_steps = timing.delay_steps(MOTOR, within(model, model.jnt_bodyid[driving]), len(actuators))
        """Physics steps after which commands act, shape (m,)."""
        self._hinges = np.arange(len(infant.joints))
        self._beginning = dict[int, _Group]()
        for delay in np.unique(self.delay_steps).tolist():
            which = np.flatnonzero(self.delay_steps == delay).astype(np.intp)
            self._beginning[delay] = _Group(delay, delay + self._control_steps, which, actuators[which], moved[which])
        self._end = max((group.end for group in self._beginning.values()), default=0)
        is_halved = model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4
        self._finish_step = mujoco.mj_step2 if is_halved else mujoco.mj_step
        """Makes a physics step from where all but new controls has been computed."""
        self._sent: deque[FloatArray] = deque(maxlen=-(-self._end // self._control_steps))

    def hold(self, data: mujoco.MjData, target_rad: FloatArray) -> FloatArray:
        """Return the commands that keep hinges at angles, shape (m,), and take them to be on their way already."""
        ahead = self._copied(data)
        mujoco.mj_forward(self._model, ahead)
        held = self._control(ahead, target_rad)[self._actuators]
        self._sent.extend([held] * (self._sent.maxlen or 0))
        return held

    def __call__(self, data: mujoco.MjData, propose: Propose) -> FloatArray:
        """Return the commands to send now, shape (m,).

        Args:
            data: The present state.
            propose: Says where hinges go, asked in the state in which their commands begin to act; of the first, the
                others that are still to come are only foreseen.
        """
        ahead, total, advance = self._copied(data), np.zeros(len(self._actuators)), mujoco.mj_step
        target_rad: FloatArray | None = None
        for step in range(self._end):
            if step:
                advance(self._model, ahead)
                advance = mujoco.mj_step
            if beginning := self._beginning.get(step):
                mujoco.mj_forward(self._model, ahead)
                advance = self._finish_step
                if target_rad is None:
                    target_rad = propose(ahead, self._hinges).copy()
                else:
                    target_rad[beginning.hinges] = propose(ahead, beginning.hinges)[beginning.hinges]
            controls = ahead.ctrl if target_rad is None else self._control(ahead, target_rad)
            for group in self._beginning.values():
                if step < group.begin:
                    self._arrive(group, step)
                    continue
                ahead.ctrl[group.actuators] = controls[group.actuators]
                if step < group.end:
                    total[group.commands] += controls[group.actuators]
        self._sent.append(total / self._control_steps)
        return self._sent[-1]

    def _copied(self, data: mujoco.MjData) -> mujoco.MjData:
        ahead = self._ahead
        ahead.qpos[:], ahead.qvel[:], ahead.act[:] = data.qpos, data.qvel, data.act
        ahead.ctrl[:], ahead.qacc_warmstart[:] = data.ctrl, data.qacc_warmstart
        return ahead

    def _arrive(self, group: _Group, step: int) -> None:
        """Let the command act that was sent before and acts in a physics step; before the first, controls are kept."""
        ago, since = divmod(group.begin - step, self._control_steps)  # In control steps, and in physics steps.
        if step and since:
            return  # It acts already.
        ago += since > 0
        if ago <= len(self._sent):
            self._ahead.ctrl[group.actuators] = self._sent[-ago][group.commands]

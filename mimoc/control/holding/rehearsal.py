"""Control of whole control steps by a forward model: what the controller would do in each physics step to come.

A command is kept for a control step, and may arrive after a delay. A copy of the state is simulated up to the moment at
which a command sent now arrives, with those that are on their way, and then through the control step, in each physics
step of which the controller acts; their mean is sent. So a posture is held as well with control steps of 20 ms as with
one command for each physics step.
"""

from collections import deque
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.control.holding.controller import Controller, Servo
from mimoc.control.holding.driven import DrivenInfant
from mimoc.senses.sense import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Timing:
    """When commands act, in physics steps."""

    control_steps: int
    """Duration of a control step."""
    delay_steps: int = 0
    """Time after which a command arrives."""


class Rehearsal:
    """Looks ahead to where a command takes effect, and finds the command of a control step from there."""

    def __init__(self, infant: DrivenInfant, gains: Servo, actuators: IntArray, timing: Timing):
        """Prepare a copy of the infant and its world.

        Args:
            infant: The infant.
            gains: Stiffness and damping of its joints.
            actuators: Indices of the actuators that are commanded; all others keep their controls.
            timing: When commands act.
        """
        self._model, self._ahead = infant.model, mujoco.MjData(infant.model)
        self._control = Controller(infant, gains, infant.model.opt.timestep)
        self._actuators, self._timing = actuators, timing
        self._sent: deque[FloatArray] = deque(maxlen=-(-timing.delay_steps // timing.control_steps) + 1)

    def reset(self) -> None:
        """Forget the commands on their way: an episode begins."""
        self._sent.clear()

    def look(self, data: mujoco.MjData) -> mujoco.MjData:
        """Return the state in which a command sent now takes effect, with all that is derived from it."""
        ahead, timing = self._ahead, self._timing
        ahead.qpos[:], ahead.qvel[:], ahead.act[:] = data.qpos, data.qvel, data.act
        ahead.ctrl[:], ahead.qacc_warmstart[:] = data.ctrl, data.qacc_warmstart
        for step in range(timing.delay_steps):
            age = -((step - timing.delay_steps) // timing.control_steps)  # In control steps: that which acts then.
            if age <= len(self._sent):
                ahead.ctrl[self._actuators] = self._sent[-age]
            mujoco.mj_step(self._model, ahead)
        mujoco.mj_forward(self._model, ahead)
        return ahead

    def send(self, target_rad: FloatArray) -> FloatArray:
        """Return the commands of the actuators, shape (m,), for a control step that begins where it looked last.

        Args:
            target_rad: Angle of each driven hinge to go to, shape (n,).
        """
        ahead, controls = self._ahead, []
        for step in range(self._timing.control_steps):
            if step:
                mujoco.mj_step(self._model, ahead)
            controls.append(self._control(ahead, target_rad)[self._actuators])
            ahead.ctrl[self._actuators] = controls[-1]
        self._sent.append(np.mean(controls, axis=0))
        return self._sent[-1]

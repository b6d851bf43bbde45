"""Control of whole control steps by a forward model: what the controller would do in each physics step to come.

In a copy of the state, each actuator first obeys the commands that are on their way to it, and the controller from when
a command sent now acts (`LateCommands`). The mean of what the controller does in the control step that begins then is
sent; what it does of the arms after that is not, but foreseen for the legs, to which commands take longer.

So a posture is held as well with control steps of 20 ms as with one command for each physics step, and what is slow to
reach the legs makes no arm act too early or too late.
"""

from collections.abc import Callable

import mujoco
import numpy as np

from mimoc.policies.control.holding.controller import Controller, Servo
from mimoc.policies.control.holding.driven import DrivenInfant
from mimoc.policies.control.late_commands import LateCommands
from mimoc.runtime.delays.timing import Timing
from mimoc.runtime.sense import FloatArray, IntArray

Propose = Callable[[mujoco.MjData, IntArray], FloatArray]
"""From a state with all that is derived from it, and some of the driven hinges, to the angle that each hinge is to go
to, shape (n,); those of hinges that were not asked for are not used."""


class Rehearsal:
    """Finds the commands of a control step by looking ahead to when they act, for each joint over its own delay."""

    def __init__(self, infant: DrivenInfant, gains: Servo, actuators: IntArray, timing: Timing):
        """Prepare a copy of the infant and its world; actuators but the m given ones keep their controls."""
        model = infant.model
        self._model, self._ahead, self._actuators = model, mujoco.MjData(model), actuators
        self._control = Controller(infant, gains, model.opt.timestep)
        self._late = LateCommands(model, actuators, timing)
        self._all_hinges = np.arange(len(infant.joints))
        self._hinges = infant.slots_of(actuators)
        is_halved = model.opt.integrator != mujoco.mjtIntegrator.mjINT_RK4
        self._finish_step = mujoco.mj_step2 if is_halved else mujoco.mj_step
        """Makes a physics step from where all but new controls has been computed."""

    @property
    def delay_steps(self) -> IntArray:
        """Physics steps after which commands act, shape (m,)."""
        return self._late.delay_steps

    def hold(self, data: mujoco.MjData, target_rad: FloatArray) -> FloatArray:
        """Return the commands that keep hinges at angles, shape (m,), and take them to be on their way already."""
        ahead = self._copied(data)
        mujoco.mj_forward(self._model, ahead)
        held = self._control(ahead, target_rad)[self._actuators]
        self._late.hold(held)
        return held

    def __call__(self, data: mujoco.MjData, propose: Propose) -> FloatArray:
        """Return the commands to send now, shape (m,).

        *propose*, which says where hinges go, is asked once for each delay, in the state in which the commands with
        that delay begin to act: the first time for all hinges, later for those alone.
        """
        ahead, late, total = self._copied(data), self._late, np.zeros(len(self._actuators))
        advance, target_rad = mujoco.mj_step, np.empty(0)
        for step in range(late.last + late.control_steps):
            if step:
                advance(self._model, ahead)
                advance = mujoco.mj_step
            if beginning := late.groups.get(step):
                advance, hinges = self._finish_step, self._hinges[beginning.commands]
                mujoco.mj_forward(self._model, ahead)
                if target_rad.size:
                    target_rad[hinges] = propose(ahead, hinges)[hinges]
                else:
                    target_rad = propose(ahead, self._all_hinges).copy()
            controls = self._control(ahead, target_rad) if target_rad.size else ahead.ctrl
            for group in late.groups.values():
                if step < group.begin:
                    late.arrive(group, step, ahead.ctrl)
                    continue
                ahead.ctrl[group.actuators] = controls[group.actuators]
                if step < group.end:
                    total[group.commands] += controls[group.actuators]
        late.send(commands := total / late.control_steps)
        return commands

    def _copied(self, data: mujoco.MjData) -> mujoco.MjData:
        ahead = self._ahead
        ahead.qpos[:], ahead.qvel[:], ahead.act[:] = data.qpos, data.qvel, data.act
        ahead.ctrl[:], ahead.qacc_warmstart[:] = data.ctrl, data.qacc_warmstart
        return ahead

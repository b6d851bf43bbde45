"""Control across delays: a forward model predicts the state in which a command will take effect.

The infant's senses tell of a past state, and its commands wait on their way to the muscles. From the newest state that
is known, a copy of the model is simulated with the commands that were sent since, up to the moment at which a command
sent now arrives; the controller acts on that prediction. The forward model is exact but for pushes, which nobody
announces: the infant learns of them after the delay of its senses.
"""

from collections import deque

import mujoco

from mimoc.studies.milestones.infant import FloatArray

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

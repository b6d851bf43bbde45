"""Noise of the commands: each actuator is driven by its command and noise in proportion to it."""

import mujoco

from mimoc.actuation.binding import Actuation
from mimoc.noise.low_pass import LowPassed
from mimoc.noise.streams import NoiseStreams
from mimoc.senses.sense import FloatArray

CHANNEL = "motor"
"""Stream of the noise."""


class MotorNoise:
    """Signal-dependent noise: commands u drive actuators by u (1 + c n), with n low-passed and of standard deviation 1.

    The standard deviation of a force thus rises in proportion to its size (Jones, Hamilton & Wolpert 2002).
    """

    def __init__(self, share: float, low_pass_s: float, timestep_s: float, actuation: Actuation, streams: NoiseStreams):
        """Disturb the commands of all commanded actuators.

        Args:
            share: The standard deviation c, as a share of the command.
            low_pass_s: Time constant of the noise.
            timestep_s: Physics step.
            actuation: The actuators.
            streams: Random numbers.
        """
        self._share, self._timestep_s, self._streams = share, timestep_s, streams
        self._actuators, self._low, self._high = actuation.actuators, actuation.low, actuation.high
        self._noise = LowPassed(len(actuation.actuators), low_pass_s)

    def reset(self, data: mujoco.MjData) -> None:
        """Begin anew, with the controls of now as commands."""
        self.commanded = data.ctrl.copy()
        """Control of each actuator of the model without noise, shape (nu,)."""
        self._noise.advance(float("inf"), self._streams[CHANNEL])

    def __call__(self, data: mujoco.MjData) -> None:
        """Set the controls for the next physics step."""
        noise = self._noise.advance(self._timestep_s, self._streams[CHANNEL])
        commands = self.commanded[self._actuators].clip(self._low, self._high)
        data.ctrl[self._actuators] = commands * (1 + self._share * noise)

    @property
    def state(self) -> list[FloatArray]:
        """The commands, and the present noise."""
        return [self.commanded, self._noise.values]

    @state.setter
    def state(self, state: list[FloatArray]) -> None:
        self.commanded, self._noise.values = state

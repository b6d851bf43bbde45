"""Noise of the commands: each actuator is driven by its command and noise in proportion to it."""

import math
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.actuation.binding import Actuation
from mimoc.noise.low_pass import LowPass
from mimoc.noise.noise import Draw, Noise, SignalNoise
from mimoc.noise.spec import NoiseEntry
from mimoc.noise.streams import NoiseStreams
from mimoc.senses.sense import FloatArray
from mimoc.units import ms_to_s

CHANNEL = "motor"
"""Stream of the noise."""


@dataclass(frozen=True)
class MotorNoise(Noise):
    """Signal-dependent noise: commands u drive actuators by u (1 + c n), with n low-passed and of standard deviation 1.

    The standard deviation of a force thus rises in proportion to its size (Jones, Hamilton & Wolpert 2002).
    """

    share: FloatArray
    """The standard deviation c, as a share of the command, shape (1,)."""
    low: FloatArray
    """Smallest command, shape (n,)."""
    high: FloatArray
    """Largest command, shape (n,)."""
    low_pass: LowPass

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return the controls that commands become, shape (k, n), and the state of the noise."""
        xp = draw.xp
        state = self.low_pass(state, draw.elapsed_s, draw.normals(sample.shape))
        return xp.minimum(xp.maximum(sample, self.low), self.high) * (1 + self.share * state), state


def bind_motor_noise(entry: NoiseEntry, actuation: Actuation) -> MotorNoise:
    """Return the noise of all commanded actuators; its amount may be 0."""
    return MotorNoise(np.array([entry.motor]), actuation.low, actuation.high, LowPass(ms_to_s(entry.low_pass_ms)))


class NoisyMotors:
    """The commands of one infant, and the noise with which they drive its actuators."""

    def __init__(self, noise: MotorNoise, timestep_s: float, actuation: Actuation, streams: NoiseStreams):
        """Disturb the commands of all commanded actuators, in each physics step."""
        self._noise, self._timestep_s = SignalNoise(noise, CHANNEL, streams), timestep_s
        self._actuators = actuation.actuators

    def reset(self, data: mujoco.MjData) -> None:
        """Begin anew, with the controls of now as commands."""
        self.commanded = data.ctrl.copy()
        """Control of each actuator of the model without noise, shape (nu,)."""
        self._noise(math.inf, self.commanded[self._actuators])

    def __call__(self, data: mujoco.MjData) -> None:
        """Set the controls for the next physics step."""
        data.ctrl[self._actuators] = self._noise(self._timestep_s, self.commanded[self._actuators])

    @property
    def state(self) -> list[Any]:
        """The commands, and the present noise."""
        return [self.commanded, self._noise.state]

    @state.setter
    def state(self, state: list[Any]) -> None:
        self.commanded, self._noise.state = state

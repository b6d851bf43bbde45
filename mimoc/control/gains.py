"""Gains: how strongly an error is answered, as a polynomial law."""

import math
from dataclasses import dataclass

import numpy as np

from mimoc.errors import ControlError
from mimoc.senses.sense import FloatArray


@dataclass(frozen=True, slots=True)
class Gains:
    """The acceleration that answers an error d: strength x (d / scale)^power towards the target, less viscosity x v.

    Errors and scales are in [m] or in [rad], whichever the task's error is in; accelerations in that per s².
    """

    strength: float
    """Acceleration at an error of one scale, [m/s²] or [rad/s²]."""
    power: float = 1.0
    """1 is a spring; more is gentler near the target."""
    scale: float = 1.0
    """Error at which the acceleration is *strength*, [m] or [rad]."""
    cap: float = math.inf
    """Larger errors are answered like this one, [m] or [rad]."""
    viscosity_per_s: float = 0.0
    """Deceleration by velocity."""

    def __post_init__(self) -> None:
        for name, least in (("strength", 0.0), ("power", 0.0), ("scale", 1e-9), ("cap", 0.0), ("viscosity_per_s", 0.0)):
            value = getattr(self, name)
            if not value >= least or (value == math.inf and name != "cap"):
                raise ControlError(f"the {name} of gains is {value:g}; give a number from {least:g} on")

    def acceleration(self, error: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the acceleration that is wanted.

        Args:
            error: From where it is to the target, shape (n,), [m] or [rad].
            velocity: Of what is to get there, shape (n,).
        """
        distance = math.sqrt(error @ error)
        if distance == 0.0:
            return -self.viscosity_per_s * velocity
        pull = self.strength * (min(distance, self.cap) / self.scale) ** self.power
        return (pull / distance) * error - self.viscosity_per_s * velocity

    def accelerations(self, errors: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the acceleration that is wanted of each of n by itself, such as joints; all of shape (n,)."""
        pulls = self.strength * (np.minimum(np.abs(errors), self.cap) / self.scale) ** self.power
        return np.sign(errors) * pulls - self.viscosity_per_s * velocities

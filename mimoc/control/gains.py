"""Gains: a polynomial feedback law from error and velocity to desired acceleration."""

import math
from dataclasses import dataclass

import numpy as np

from mimoc.errors import ControlError
from mimoc.senses.sense import FloatArray


@dataclass(frozen=True, slots=True)
class Gains:
    """Feedback law for an error d and velocity v: strength x (d / scale)^power towards the target, less viscosity x v.

    Errors and scales are in [m] or [rad], as the error of the objective; accelerations are in [m/s²] or [rad/s²].

    Example:
        >>> from mimoc import Gains
        >>> gentle = Gains(strength=200.0, viscosity_per_s=30.0)  # 200 (m/s²)/m, and 30 (m/s²)/(m/s) against motion.
        >>> gentle.power, gentle.cap
        (1.0, inf)
    """

    strength: float
    """Acceleration at an error of one scale, [m/s²] or [rad/s²]."""
    power: float = 1.0
    """1 is a spring; more is gentler near the target."""
    scale: float = 1.0
    """Error at which the acceleration is *strength*, [m] or [rad]."""
    cap: float = math.inf
    """Error at which the acceleration saturates, [m] or [rad]."""
    viscosity_per_s: float = 0.0
    """Deceleration per unit of velocity."""

    def __post_init__(self) -> None:
        for name, least in (("strength", 0.0), ("power", 0.0), ("scale", 1e-9), ("cap", 0.0), ("viscosity_per_s", 0.0)):
            value = getattr(self, name)
            if not value >= least or (value == math.inf and name != "cap"):
                raise ControlError(f"the {name} of gains is {value:g}; give a number of at least {least:g}")

    def acceleration(self, error: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return the desired acceleration.

        Args:
            error: Vector from the present value to the target, shape (n,), [m] or [rad].
            velocity: Present velocity, shape (n,).
        """
        distance = math.sqrt(error @ error)
        if distance == 0.0:
            return -self.viscosity_per_s * velocity
        pull = self.strength * (min(distance, self.cap) / self.scale) ** self.power
        return (pull / distance) * error - self.viscosity_per_s * velocity

    def accelerations(self, errors: FloatArray, velocities: FloatArray) -> FloatArray:
        """Return the desired accelerations of n independent values, such as joint angles; all of shape (n,)."""
        pulls = self.strength * (np.minimum(np.abs(errors), self.cap) / self.scale) ** self.power
        return np.sign(errors) * pulls - self.viscosity_per_s * velocities

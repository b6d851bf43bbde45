"""Posture: target angles of joints, and gains: a feedback law from error and velocity to desired acceleration."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from mimoc.base.classes import described
from mimoc.base.errors import ControlError, UnknownNameError
from mimoc.runtime.sense import FloatArray


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


HOLDING = Gains(100.0, cap=0.3, viscosity_per_s=20.0)


class Posture:
    """Moves joints to angles and holds them there, as far as objectives of higher priority allow.

    Example:
        >>> import mimoc
        >>> bent = mimoc.Posture({"robot:right_elbow": -1.2})  # [rad]; all other joints stay where they are.
        >>> bent.angles_rad = {"robot:right_elbow": -0.6}  # At any time.
    """

    def __init__(
        self, angles_rad: Mapping[str, float] | None = None, joints: Sequence[str] | None = None, gains: Gains = HOLDING
    ):
        """Create the posture.

        Args:
            angles_rad: Target angles by joint; other joints keep the angles that they have when control begins.
            joints: Controlled joints, such as those of the trunk while the hands reach; None means all joints, which
                is only possible at the lowest priority.
            gains: Gains for the angle of each joint; with a strength of 0, there is only damping.

        Raises:
            ControlError: If an angle is not finite.
        """
        self.joints = None if joints is None else tuple(joints)
        self.angles_rad, self.gains = angles_rad or {}, gains

    @property
    def angles_rad(self) -> Mapping[str, float]:
        """Target angles by joint; they can be changed at any time."""
        return self._angles_rad

    @angles_rad.setter
    def angles_rad(self, angles_rad: Mapping[str, float]) -> None:
        if not isinstance(angles_rad, Mapping):
            raise ControlError(f"the angles are {described(angles_rad)}; give a dictionary of radians by joint")
        for joint, angle_rad in angles_rad.items():
            if not math.isfinite(angle_rad):
                raise ControlError(f"the angle of '{joint}' is {angle_rad}; give a finite number of radians")
        self._angles_rad = MappingProxyType({joint: float(angle) for joint, angle in angles_rad.items()})

    def members(self, joints: Sequence[str]) -> list[int]:
        """Return the indices of the controlled joints among some joints.

        Raises:
            UnknownNameError: If a controlled joint, or one with a target angle, is not among them.
        """
        for name in (*(self.joints or ()), *self._angles_rad):
            if name not in joints:
                raise UnknownNameError("joint that is allowed to move", name, joints)
        return [index for index, name in enumerate(joints) if self.joints is None or name in self.joints]

    def targets_rad(self, joints: Sequence[str], present_rad: FloatArray) -> FloatArray:
        """Return the target angle of each of n joints, shape (n,).

        Args:
            joints: Their names.
            present_rad: Target angles of joints for which none is given, shape (n,).
        """
        targets_rad = present_rad.copy()
        for name, angle_rad in self._angles_rad.items():
            if name in joints:
                targets_rad[joints.index(name)] = angle_rad
        return targets_rad

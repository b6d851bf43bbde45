"""Posture: what joints do by themselves."""

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType

from mimoc.control.gains import Gains
from mimoc.errors import ControlError, UnknownNameError
from mimoc.senses.sense import FloatArray

HOLDING = Gains(100.0, cap=0.3, viscosity_per_s=20.0)
"""For joint angles."""


class Posture:
    """Joints go to some angles and come to rest there, as far as nothing before it wants them elsewhere."""

    def __init__(
        self,
        angles_rad: Mapping[str, float] | None = None,
        joints: Sequence[str] | None = None,
        gains: Gains = HOLDING,
    ):
        """Say which joints and which angles.

        Args:
            angles_rad: By joint; those that are not named stay where they are when control begins.
            joints: What is held, such as the trunk while hands reach; None is all joints, which comes last.
            gains: For the angle of each joint by itself; a strength of 0 leaves damping alone.

        Raises:
            ControlError: If an angle is not finite.
        """
        self.joints = None if joints is None else tuple(joints)
        self.angles_rad, self.gains = angles_rad or {}, gains

    @property
    def angles_rad(self) -> Mapping[str, float]:
        """Where joints are to go, by joint; it can be set anew at any time."""
        return self._angles_rad

    @angles_rad.setter
    def angles_rad(self, angles_rad: Mapping[str, float]) -> None:
        for joint, angle_rad in angles_rad.items():
            if not math.isfinite(angle_rad):
                raise ControlError(f"the angle of '{joint}' is {angle_rad}; give a finite number of radians")
        self._angles_rad = MappingProxyType({joint: float(angle) for joint, angle in angles_rad.items()})

    def members(self, joints: Sequence[str]) -> list[int]:
        """Return which of some joints it is about.

        Raises:
            UnknownNameError: If it is about others, or has an angle for others.
        """
        for name in (*(self.joints or ()), *self._angles_rad):
            if name not in joints:
                raise UnknownNameError("joint that is allowed to move", name, joints)
        return [index for index, name in enumerate(joints) if self.joints is None or name in self.joints]

    def targets_rad(self, joints: Sequence[str], present_rad: FloatArray) -> FloatArray:
        """Return where each of n joints is to go, shape (n,).

        Args:
            joints: Their names.
            present_rad: Where those stay that are not named, shape (n,).
        """
        targets_rad = present_rad.copy()
        for name, angle_rad in self._angles_rad.items():
            if name in joints:
                targets_rad[joints.index(name)] = angle_rad
        return targets_rad

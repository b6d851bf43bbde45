"""Arousal on a device: how much of its muscle tone the infant in each world has."""

from collections.abc import Sequence
from typing import Any

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp

from mimoc.runtime.arousal import FIELDS, MOST, OF_BIAS, Arousal, more_bias, more_spring
from mimoc.runtime.device.arrays import put


class DeviceArousal:
    """The arousal of all infants; as built, until it is set."""

    def __init__(self, arousals: Sequence[Arousal], body: torch.Tensor, angles: Any, model: mjw.Model):
        """Find what it changes.

        Args:
            arousals: Of the different bodies.
            body: Which of them lives in each world, shape (worlds,).
            angles: Address of the angle of each joint, which is the same in all bodies.
            model: The model of all worlds, as built, whose arrays of these fields each world has for itself.
        """
        of_motors, of_hinges = (
            np.stack([getattr(arousal, tone) for arousal in arousals]) for tone in ("of_motors", "of_hinges")
        )
        motors, hinges = (np.flatnonzero(tone.any(axis=(0, 2))) for tone in (of_motors, of_hinges))
        self._of_motors, self._of_hinges = put(of_motors[:, motors])[body], put(of_hinges[:, hinges])[body]
        self._motors, self._hinges, self._angles = put(motors), put(hinges), put(angles[hinges])
        self._fields = [wp.to_torch(getattr(model, name)) for name in FIELDS]
        bias, stiffness, rest_rad = self._fields
        self._bias = bias[:, self._motors, :OF_BIAS].clone()
        self._relaxed = stiffness[:, self._hinges].clone(), rest_rad[:, self._angles].clone()
        self.as_built = put([arousal.as_built for arousal in arousals])[body].float()
        self.level = self.as_built.clone()
        """Arousal in each world now, shape (worlds,)."""
        self._is_set = False

    def set(self, level: torch.Tensor) -> None:
        """Change the arousal of all worlds, shape (worlds,); what is beyond 0 and 2 is clipped."""
        self.level, self._is_set = level.clamp(0, MOST), True
        more = (self.level - self.as_built)[:, None]
        bias, stiffness, rest_rad = self._fields
        if self._motors.numel():
            bias[:, self._motors, :OF_BIAS] = more_bias(self._bias, self._of_motors, more)
        if self._hinges.numel():
            now = more_spring(*self._relaxed, self._of_hinges, more)
            stiffness[:, self._hinges], rest_rad[:, self._angles] = now

    def begin(self, begins: torch.Tensor) -> None:
        """Let infants that begin an episode have the arousal that they are built for; a mask of shape (worlds,)."""
        if self._is_set:
            self.set(torch.where(begins, self.as_built, self.level))

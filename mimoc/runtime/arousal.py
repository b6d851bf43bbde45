"""Arousal: how much of its muscle tone an infant has in an episode.

Tone is what muscles do without a command. The manifest has it for a quiet infant, whose arousal is 1, by actuator, in
proportion to arousal: of a motor, what it adds to its three bias parameters,

    bias = bias as built + (arousal - arousal as built) tone

and of a muscle, what it adds to the stiffness k of its hinge and to k q with the angle q at which the hinge is at rest.
"""

import math
from numbers import Real
from typing import Any

import mujoco
import numpy as np

from mimoc.schema.actuation import ActuationEntry

OF_BIAS, OF_HINGE = 3, 2
"""Number of parameters that tone changes."""
MOST = 2.0
"""Largest arousal."""
FIELDS = "actuator_biasprm", "jnt_stiffness", "qpos_spring"
"""Arrays of the model that arousal changes: of motors, and of hinges with muscles."""


class Arousal:
    """The muscle tone of an infant, in its model."""

    def __init__(self, entry: ActuationEntry, model: mujoco.MjModel):
        """Find the actuators of *entry* with muscle tone in *model*, in which no episode has changed anything yet."""
        self._model, self.as_built, self._level = model, entry.arousal, entry.arousal
        self.of_motors, self.of_hinges = np.zeros((model.nu, OF_BIAS)), np.zeros((model.njnt, OF_HINGE))
        """Tone of all actuators and of all joints."""
        for actuator in entry.actuators:
            if len(actuator.tone) == OF_BIAS:
                self.of_motors[model.actuator(actuator.name).id] = actuator.tone
            elif actuator.tone:
                self.of_hinges[model.joint(actuator.joint).id] = actuator.tone
        self._motors, self._hinges = (np.flatnonzero(tone.any(axis=1)) for tone in (self.of_motors, self.of_hinges))
        self._angles = model.jnt_qposadr[self._hinges]
        self._bias = model.actuator_biasprm[self._motors, :OF_BIAS]
        self._relaxed = model.jnt_stiffness[self._hinges], model.qpos_spring[self._angles]

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of the arrays of the model that it changes."""
        return (*(FIELDS[:1] if self._motors.size else ()), *(FIELDS[1:] if self._hinges.size else ()))

    @property
    def level(self) -> float:
        """Arousal now, from 0 to 2; setting it changes the model. A published infant has no muscle tone to change."""
        return self._level

    @level.setter
    def level(self, level: float) -> None:
        self._level = checked_arousal(level)
        more = np.array([self._level - self.as_built])
        self._model.actuator_biasprm[self._motors, :OF_BIAS] = more_bias(self._bias, self.of_motors[self._motors], more)
        stiffness, rest_rad = more_spring(*self._relaxed, self.of_hinges[self._hinges], more)
        self._model.jnt_stiffness[self._hinges], self._model.qpos_spring[self._angles] = stiffness, rest_rad


def more_bias(bias: Any, tone: Any, more: Any) -> Any:
    """Return bias parameters, shape (..., n, 3), of motors with so much more arousal, shape (..., 1)."""
    return bias + more[..., None] * tone


def more_spring(stiffness: Any, rest_rad: Any, tone: Any, more: Any) -> tuple[Any, Any]:
    """Return stiffness and angle at rest, shape (..., n), of hinges with so much more arousal, shape (..., 1)."""
    now = stiffness + more * tone[..., 0]
    return now, rest_rad + more * (tone[..., 1] - tone[..., 0] * rest_rad) / now


def checked_arousal(level: Any) -> float:
    """Return an arousal.

    Raises:
        ValueError: If it is none from 0 to 2.
    """
    if isinstance(level, bool) or not isinstance(level, Real) or not 0 <= float(level) <= MOST or math.isnan(level):
        raise ValueError(f"expected an arousal from 0 to {MOST:g}, got {level!r}")
    return float(level)

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

from mimoc.actuation.spec import ActuationEntry
from mimoc.base.model_fields import ModelField

OF_BIAS, OF_HINGE = 3, 2
"""Number of parameters that tone changes."""
MOST = 2.0
"""Largest arousal."""


class Arousal:
    """The muscle tone of an infant, in its model."""

    def __init__(self, entry: ActuationEntry, model: mujoco.MjModel):
        """Find the actuators of *entry* with muscle tone in *model*, in which no episode has changed anything yet."""
        self._model, self.as_built = model, entry.arousal
        toned = [actuator for actuator in entry.actuators if any(actuator.tone)]
        motors = [actuator for actuator in toned if len(actuator.tone) == OF_BIAS]
        muscles = [actuator for actuator in toned if len(actuator.tone) == OF_HINGE]
        self._motors = np.array([model.actuator(motor.name).id for motor in motors], np.intp)
        self._hinges = np.array([model.joint(muscle.joint).id for muscle in muscles], np.intp)
        self._angles = model.jnt_qposadr[self._hinges].astype(np.intp)
        self._tone = np.array([motor.tone for motor in motors]).reshape(-1, OF_BIAS)
        self._stiffness, self._moment = np.array([muscle.tone for muscle in muscles]).reshape(-1, OF_HINGE).T
        self._bias = model.actuator_biasprm[self._motors, :OF_BIAS]
        self._relaxed = model.jnt_stiffness[self._hinges], model.qpos_spring[self._angles]
        self.level = self.as_built
        """Arousal now."""

    @property
    def model_fields(self) -> tuple[ModelField, ...]:
        """What it changes in the model."""
        rows = {"actuator_biasprm": self._motors, "jnt_stiffness": self._hinges, "qpos_spring": self._angles}
        return tuple(ModelField(name, which) for name, which in rows.items() if which.size)

    def carry_on(self, former: "Arousal") -> None:
        """Keep what an episode has changed of the arousal of the same infant at another age."""
        self.set(None if former.level == former.as_built else former.level)

    def set(self, level: float | None) -> None:
        """Change the arousal, to that as built for None; a published infant has no muscle tone to change."""
        self.level = self.as_built if level is None else level
        more, (stiffness, rest_rad) = self.level - self.as_built, self._relaxed
        self._model.actuator_biasprm[self._motors, :OF_BIAS] = self._bias + more * self._tone
        now = stiffness + more * self._stiffness
        self._model.jnt_stiffness[self._hinges] = now
        self._model.qpos_spring[self._angles] = rest_rad + more * (self._moment - self._stiffness * rest_rad) / now


def checked_arousal(level: Any) -> float:
    """Return an arousal.

    Raises:
        ValueError: If it is none from 0 to 2.
    """
    if isinstance(level, bool) or not isinstance(level, Real) or not 0 <= float(level) <= MOST or math.isnan(level):
        raise ValueError(f"expected an arousal from 0 to {MOST:g}, got {level!r}")
    return float(level)

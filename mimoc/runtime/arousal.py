"""Arousal: how much of its muscle tone an infant has in an episode.

Tone is what muscles do without a command. The manifest has it for a quiet infant, whose arousal is 1, by actuator, in
proportion to arousal: of a motor, what it adds to its three bias parameters,

    bias = bias as built + (arousal - arousal as built) tone

and of a muscle, what it adds to the stiffness k of its hinge and to k q with the angle q at which the hinge is at rest.
"""

import math
from collections.abc import Callable, Sequence
from numbers import Real
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.runtime.sense import IntArray
from mimoc.schema.actuation import ActuationEntry

OF_BIAS, OF_HINGE = 3, 2  # Number of parameters that tone changes.
MAX_AROUSAL = 2.0
FIELDS = "actuator_biasprm", "jnt_stiffness", "qpos_spring"  # Fields of the model that arousal changes.


Tone = tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]
"""Tone of all motors, shape (actuators, 3), and of all hinges with muscles, shape (joints, 2)."""


class ToneInModels:
    """The muscle tone of k infants in the fields of their models, on the CPU and on a device."""

    def __init__(
        self, tones: Sequence[Tone], fields: Sequence[Any], angles: IntArray, put: Callable[[Any], Any] = np.asarray
    ):
        of_motors, of_hinges = (np.stack(tone) for tone in zip(*tones, strict=True))
        motors, hinges = (np.flatnonzero(tone.any(axis=(0, 2))) for tone in (of_motors, of_hinges))
        self.fields = (*(FIELDS[:1] if len(motors) else ()), *(FIELDS[1:] if len(hinges) else ()))
        self._of_motors = put(of_motors[:, motors])
        self._of_hinges = put(of_hinges[:, hinges])
        self._motors = put(motors)
        self._hinges = put(hinges)
        self._angles = put(angles[hinges])
        self._bias, self._stiffness, self._rest_rad = fields
        self._as_built = [self._bias[:, self._motors, :OF_BIAS]]
        self._as_built += [self._stiffness[:, self._hinges], self._rest_rad[:, self._angles]]

    def write(self, more: Any) -> None:
        """Write the models for arousal that differs from that as built by *more*, shape (k,)."""
        bias, stiffness, rest_rad = self._as_built
        if len(self._motors):
            self._bias[:, self._motors, :OF_BIAS] = bias + more[:, None, None] * self._of_motors
        if len(self._hinges):
            stiffer, moment = self._of_hinges[..., 0], self._of_hinges[..., 1]
            now = stiffness + more[:, None] * stiffer
            self._stiffness[:, self._hinges] = now
            self._rest_rad[:, self._angles] = rest_rad + more[:, None] * (moment - stiffer * rest_rad) / now


def tone_of(entry: ActuationEntry, model: mujoco.MjModel) -> Tone:
    """Return the tone of all actuators and of all joints."""
    of_motors, of_hinges = np.zeros((model.nu, OF_BIAS)), np.zeros((model.njnt, OF_HINGE))
    for actuator in entry.actuators:
        if len(actuator.tone) == OF_BIAS:
            of_motors[model.actuator(actuator.name).id] = actuator.tone
        elif actuator.tone:
            of_hinges[model.joint(actuator.joint).id] = actuator.tone
    return of_motors, of_hinges


class Arousal:
    """The arousal of an infant, in its model."""

    def __init__(self, entry: ActuationEntry, model: mujoco.MjModel):
        self.as_built, self._level = entry.arousal, entry.arousal
        fields = [getattr(model, name)[None] for name in FIELDS]
        self._tone = ToneInModels([tone_of(entry, model)], fields, model.jnt_qposadr)

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of the arrays of the model that it changes."""
        return self._tone.fields

    @property
    def level(self) -> float:
        """Arousal now, from 0 to 2; setting it changes the model. A published infant has no muscle tone to change."""
        return self._level

    @level.setter
    def level(self, level: float) -> None:
        self._level = checked_arousal(level)
        self._tone.write(np.array([self._level - self.as_built]))


def checked_arousal(level: Any) -> float:
    """Return an arousal, or raise a ValueError if it is none."""
    if (
        isinstance(level, bool)
        or not isinstance(level, Real)
        or not 0 <= float(level) <= MAX_AROUSAL
        or math.isnan(level)
    ):
        raise ValueError(f"expected an arousal from 0 to {MAX_AROUSAL:g}, got {level!r}")
    return float(level)

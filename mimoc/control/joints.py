"""Joints: where those are that a controller moves, and how hard they may accelerate."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.senses.sense import FloatArray, IntArray

BRAKING_PER_S = 20.0
"""How fast a joint may approach the end of its range, by the way that is left."""
MARGIN_RAD = 0.02
"""How far from the end it is to stop."""


@dataclass(frozen=True, slots=True)
class Joints:
    """The n hinges that a controller moves."""

    names: tuple[str, ...]
    """As the model has them."""
    indices: IntArray
    """In the model, shape (n,)."""
    angles: IntArray
    """Where their angles stand in the state, shape (n,)."""
    speeds: IntArray
    """Where their speeds do, shape (n,)."""
    low_rad: FloatArray
    """Least angle to stop at, shape (n,); -inf where there is none."""
    high_rad: FloatArray
    """Largest angle, shape (n,)."""

    def bounds(self, data: mujoco.MjData) -> tuple[FloatArray, FloatArray]:
        """Return the least and the largest acceleration with which each still stops in time, shape (n,) each.

        They are those of a critically damped spring, so that a joint that keeps to them never passes its end.
        """
        angles_rad = data.qpos[self.angles]
        braking = -2.0 * BRAKING_PER_S * data.qvel[self.speeds]
        least = BRAKING_PER_S**2 * (self.low_rad - angles_rad) + braking
        return least, BRAKING_PER_S**2 * (self.high_rad - angles_rad) + braking


def find_joints(names: Sequence[str], model: mujoco.MjModel) -> Joints:
    """Return the hinges of some names."""
    indices = np.array([model.joint(name).id for name in names], np.intp)
    limited = model.jnt_limited[indices].astype(bool)
    low_rad, high_rad = model.jnt_range[indices].T
    margin_rad = np.minimum(MARGIN_RAD, (high_rad - low_rad) / 4)
    return Joints(
        names=tuple(names),
        indices=indices,
        angles=model.jnt_qposadr[indices].astype(np.intp),
        speeds=model.jnt_dofadr[indices].astype(np.intp),
        low_rad=np.where(limited, low_rad + margin_rad, -np.inf),
        high_rad=np.where(limited, high_rad - margin_rad, np.inf),
    )

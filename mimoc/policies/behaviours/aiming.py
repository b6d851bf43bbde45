"""From the velocity that a part of the body is to have to the angles that its joints are to go to.

Joint speeds v follow by damped least squares (Nakamura & Hanafusa 1986), v = W Jᵀ (J W Jᵀ + λ² I)⁻¹ x, with the wanted
velocities x, their Jacobian J and weights W; what leaves x unchanged pulls joints to where they rest. A joint goes to

    angle + (2 / w) v,

by which the spring K = I w² of the controller just makes up for its damper D = 2 I w, so that it turns at the speed v.
"""

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from mimoc.policies.control.holding.controller import FREQUENCY_RAD_S
from mimoc.policies.control.holding.driven import DrivenInfant
from mimoc.runtime.sense import FloatArray, IntArray

LEAD_S = 2.0 / FREQUENCY_RAD_S
RESTING_PER_S = 1.0
"""How fast joints go back to where they rest, as far as the aim leaves them free."""
MARGIN_RAD = 0.02
"""How far from the ends of their ranges joints stay."""


@dataclass(frozen=True)
class Aim:
    """Some joints, m of them, that move a part of the body."""

    infant: DrivenInfant
    joints: IntArray
    """Indices among the driven hinges of the infant, shape (m,)."""
    weights: FloatArray
    """How readily each moves, shape (m,)."""
    damping: float
    """λ, in [m] for places, without a unit for directions: below it, a direction counts as not reachable."""

    def angles(
        self, ahead: mujoco.MjData, velocity: FloatArray, jacobian: FloatArray, rest_rad: FloatArray
    ) -> FloatArray:
        """Return the angles in range, (m,), to go to for a *velocity*, (k,), with a *jacobian*, (k, nv)."""
        infant = self.infant
        now_rad = ahead.qpos[infant.angles[self.joints]]
        by_joint = jacobian[:, infant.dofs[self.joints]]
        weighted = self.weights[:, None] * by_joint.T
        inverse = weighted @ np.linalg.inv(by_joint @ weighted + self.damping**2 * np.eye(len(velocity)))
        resting = RESTING_PER_S * (rest_rad - now_rad)
        speeds = inverse @ velocity + resting - inverse @ (by_joint @ resting)
        low_rad, high_rad = self._range_rad
        return np.minimum(np.maximum(now_rad + LEAD_S * speeds, low_rad), high_rad)

    @cached_property
    def _range_rad(self) -> tuple[FloatArray, FloatArray]:
        low_rad, high_rad = self.infant.model.jnt_range[self.infant.joints[self.joints]].T
        margin_rad = np.minimum(MARGIN_RAD, (high_rad - low_rad) / 4)
        return low_rad + margin_rad, high_rad - margin_rad

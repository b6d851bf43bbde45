"""Infants that move by a policy, whose commands to single limbs are made larger or smaller."""

from collections.abc import Callable, Iterator, Sequence

import mujoco
import numpy as np

from mimoc.policies.policy import Policy
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.rollout import policy_of
from mimoc.senses.sense import FloatArray, Observation

POLICY = "general_movements"
"""What moves the infants, by the name of the policy."""
LIMBS = ("left_arm", "right_arm", "left_hip", "right_hip", "left_knee", "right_knee")
"""Parts whose drive has a gain of its own; feet and toes are driven with the knee."""
OF_LIMB = {
    "arm": ("shoulder", "elbow", "wrist", "hand", "fingers"),
    "hip": ("hip",),
    "knee": ("knee", "foot", "toes"),
}
"""Beginnings of the names of actuators, after the side."""
Forces = Callable[[mujoco.MjData], None]
"""Sets forces from outside, which act for a control step."""


class Mover:
    """Moves an infant by a policy, and counts its control steps.

    With the command c of the policy, the command at rest r = clip(0, low, high), and the gain g of an actuator's limb,
    the infant is commanded clip(r + g (c - r), low, high).
    """

    def __init__(self, env: InfantEnv, seed: int, policy: str = POLICY, forces: Forces | None = None):
        """Reset the infant, and bind the policy to it; *seed* is that of both."""
        self.env = env
        self._observation: Observation = env.reset(seed=seed)[0]
        self._policy: Policy = policy_of(env, policy)
        self._generator, self._forces = np.random.default_rng(seed), forces
        self._limbs = limb_of_actuators(env)
        self._rest = np.clip(0.0, env.action_space.low, env.action_space.high)
        self.gains = np.ones(len(LIMBS))
        """The gain of each limb, shape (6,)."""

    def move(self, seconds: float) -> FloatArray:
        """Let time pass; return the configurations after each control step, shape (t, nq)."""
        return np.array([data.qpos.copy() for data in self.steps(seconds)])

    def steps(self, seconds: float) -> Iterator[mujoco.MjData]:
        """Yield the state after each control step of some time."""
        for _ in range(round(seconds * self.rate_hz)):
            if self._forces:
                self._forces(self.env.data)
            action = self._policy(self._generator, self._observation)
            self._observation = self.env.step(self._scaled(action))[0]
            yield self.env.data

    @property
    def rate_hz(self) -> float:
        """Control steps per second."""
        return 1000.0 / self.env.manifest.step_ms

    def _scaled(self, action: np.ndarray) -> np.ndarray:
        gains = np.append(self.gains, 1.0)[self._limbs]
        space = self.env.action_space
        return np.clip(self._rest + gains * (action - self._rest), space.low, space.high).astype(np.float32)


def limb_of_actuators(env: InfantEnv) -> np.ndarray:
    """Return the place in `LIMBS` of the limb that each element of an action drives, shape (n,); -1 for none."""
    names = [env.model.actuator(int(index)).name.removeprefix("act:") for index in env.actuation.actuators]
    return np.array([_limb(name) for name in names])


def _limb(name: str) -> int:
    side, _, rest = name.partition("_")
    limbs: Sequence[str] = [part for part, starts in OF_LIMB.items() if rest.startswith(starts)]
    limb = f"{side}_{limbs[0]}" if limbs else ""
    return LIMBS.index(limb) if limb in LIMBS else -1

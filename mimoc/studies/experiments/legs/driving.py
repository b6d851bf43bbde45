"""Infants that move by a policy, whose commands to single limbs are made larger or smaller."""

from collections.abc import Callable, Iterator, Sequence

import mujoco
import numpy as np

from mimoc.movement.filming import SETTLING_S, Film, Filmed
from mimoc.policies.batch import batch_of_one
from mimoc.policies.general_movements.binding import Moving
from mimoc.policies.general_movements.joints import LIMBS as POLICY_LIMBS
from mimoc.policies.policy import Policy, PolicyMaker
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray, Observation

LIMBS = ("left_arm", "right_arm", "left_hip", "right_hip", "left_knee", "right_knee")
"""Parts whose drive has a gain of its own; feet and toes are driven with the knee."""
OF_LIMB = {"arm": ("shoulder", "elbow", "wrist", "hand", "fingers"), "hip": ("hip",), "knee": ("knee", "foot", "toes")}
"""Beginnings of the names of actuators, after the side."""
PARTS = {"arm": ("arm",), "leg": ("hip", "knee")}  # Parts of the limbs of the policy, whose bursts begin at one rate.
Forces = Callable[[mujoco.MjData], None]  # Sets forces from outside, which act for a control step.


class Mover:
    """Moves an infant by a policy, and measures how fast its limbs move.

    With the command c of the policy, the command at rest r = clip(0, low, high), and the gain g of an actuator's part,
    the infant is commanded clip(r + g (c - r), low, high). Without a policy of the caller's, it is `general_movements`,
    whose bursts of an arm or a leg can also begin more often: by the geometric mean of the gains of its parts.
    """

    def __init__(self, env: InfantEnv, seed: int, maker: PolicyMaker | None = None, forces: Forces | None = None):
        """Reset the infant, and bind a policy to it; *seed* is that of both."""
        self.env = env
        self._observation: Observation = env.reset(seed=seed)[0]
        self._moving = None if maker else Moving(batch_of_one(env))
        self._policy: Policy = maker(env) if maker else self._move_itself
        self._generator, self._forces = np.random.default_rng(seed), forces
        self._limbs, self._limbs_of_dofs = limb_of_actuators(env), limb_of_dofs(env.model)
        self._low, self._high = env.actuation.low, env.actuation.high
        self._rest = np.clip(0.0, self._low, self._high)
        self._gains = np.ones(len(LIMBS))
        self._movement, self._since = np.zeros(len(LIMBS)), 0

    def set_gains(self, gains: FloatArray, *, rates: bool = False) -> None:
        """Change the gain of the strength of each part of `LIMBS`, shape (6,), and perhaps of its rate as well."""
        self._gains = np.asarray(gains, np.float64)
        if rates and self._moving:
            self._moving.movement.rate_gains = np.array([[self._rate(limb) for limb in POLICY_LIMBS]])

    def move(self, seconds: float) -> FloatArray:
        """Let time pass; return the configurations after each control step, shape (t, nq)."""
        return np.array([data.qpos.copy() for data in self.steps(seconds)])

    def film(self, seconds: float) -> Filmed:
        """Let time pass, a second of it before the film begins; return what a camera above the infant saw."""
        film = Film()
        for _ in self.steps(SETTLING_S + seconds):
            film.watch(self.env)
        return film.develop(self.env.manifest.name)

    def steps(self, seconds: float) -> Iterator[mujoco.MjData]:
        """Yield the state after each control step of some time."""
        for _ in range(round(seconds * self.rate_hz)):
            if self._forces:
                self._forces(self.env.data)
            action = self._policy(self._generator, self._observation)
            gains = np.append(self._gains, 1.0)[self._limbs]
            scaled = np.clip(self._rest + gains * (action - self._rest), self._low, self._high).astype(np.float32)
            self._observation = self.env.step(scaled)[0]
            slots, size = self._limbs_of_dofs + 1, len(LIMBS) + 1
            sums = np.bincount(slots, np.abs(self.env.data.qvel), size)
            speeds = (sums / np.maximum(np.bincount(slots, minlength=size), 1))[1:]
            self._movement, self._since = self._movement + speeds, self._since + 1
            yield self.env.data

    def take_movement(self) -> FloatArray:
        """Return the mean joint speed of each part of `LIMBS` since this was last asked for, shape (6,), [rad/s]."""
        movement = self._movement / max(self._since, 1)
        self._movement, self._since = np.zeros(len(LIMBS)), 0
        return movement

    @property
    def rate_hz(self) -> float:
        """Control steps per second."""
        return 1000.0 / self.env.manifest.step_ms

    def _move_itself(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        assert self._moving
        return self._moving([generator], observation)[0]

    def _rate(self, limb: str) -> float:
        """Return the gain of the rate of a limb of the policy; 1 for trunk and head."""
        side, _, part = limb.partition("_")
        parts = [LIMBS.index(f"{side}_{name}") for name in PARTS.get(part, ())]
        return float(np.exp(np.log(self._gains[parts]).mean())) if parts else 1.0


def limb_of_actuators(env: InfantEnv) -> np.ndarray:
    """Return the place in `LIMBS` of the limb that each element of an action drives, shape (n,); -1 for none."""
    names = [env.model.actuator(int(index)).name.removeprefix("act:") for index in env.actuation.actuators]
    return np.array([_limb(name) for name in names])


def limb_of_dofs(model: mujoco.MjModel) -> np.ndarray:
    """Return the place in `LIMBS` of the limb that each degree of freedom belongs to, shape (nv,); -1 for none."""
    return np.array([_limb(model.joint(int(joint)).name.removeprefix("robot:")) for joint in model.dof_jntid])


def _limb(name: str) -> int:
    side, _, rest = name.partition("_")
    limbs: Sequence[str] = [part for part, starts in OF_LIMB.items() if rest.startswith(starts)]
    limb = f"{side}_{limbs[0]}" if limbs else ""
    return LIMBS.index(limb) if limb in LIMBS else -1

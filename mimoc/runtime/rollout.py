"""Run an infant under a policy and sum up what happened."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from time import perf_counter

import mujoco
import numpy as np

from mimoc.errors import UnknownNameError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.senses.sense import FloatArray
from mimoc.units import ms_to_s

Policy = Callable[[np.random.Generator], np.ndarray]


@dataclass(frozen=True, slots=True)
class Summary:
    """What happened in a run; everything but the wall time follows from bundle, policy and seed."""

    steps: int
    """Control steps taken."""
    episodes: int
    """Episodes begun."""
    simulated_s: float
    wall_s: float
    """Time it took, pictures and printing not counted."""
    total_reward: float
    hip_path_m: float
    """Length of the way that the hip went."""
    head_height_m: tuple[float, float]
    """Lowest and highest place of the head's centre, above z = 0."""
    joint_speed_rad_s: float
    """Mean speed over joints and steps."""
    unstable: bool
    """Whether an episode ended because the simulation broke down."""


def random_policy(env: InfantEnv) -> Policy:
    """Return a policy that draws every command evenly from its range."""
    low, high = _command_range(env)
    return lambda generator: generator.uniform(low, high).astype(np.float32)


def zero_policy(env: InfantEnv) -> Policy:
    """Return a policy that commands nothing."""
    action = np.clip(0.0, *_command_range(env)).astype(np.float32)
    return lambda generator: action


def _command_range(env: InfantEnv) -> tuple[FloatArray, FloatArray]:
    actuators = env.manifest.actuation.actuators
    return np.array([a.action_low for a in actuators]), np.array([a.action_high for a in actuators])


POLICIES: Mapping[str, Callable[[InfantEnv], Policy]] = {"random": random_policy, "zero": zero_policy}
"""By the name that `mimo run --policy` takes."""


class Run:
    """A run of an environment under a policy: step it as often as wanted, then sum it up."""

    def __init__(self, env: InfantEnv, policy: str, seed: int):
        """Reset *env*; *policy* is a key of `POLICIES`, *seed* that of the policy and the reset.

        Raises:
            UnknownNameError: If there is no such policy.
        """
        if policy not in POLICIES:
            raise UnknownNameError("policy", policy, POLICIES)
        self._env, self._act = env, POLICIES[policy](env)
        self._generator = np.random.default_rng(seed)
        self._wall_s, self._reward, self._episodes, self._unstable = 0.0, 0.0, 1, False
        model = env.model
        self._hinges = model.jnt_dofadr[model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE]
        self._hip_m: list[FloatArray] = []
        self._head_m: list[float] = []
        self._speeds: list[float] = []
        env.reset(seed=seed)

    def step(self) -> None:
        """Take one control step; an episode that ends is followed by another."""
        action = self._act(self._generator)
        start = perf_counter()
        _, reward, terminated, truncated, info = self._env.step(action)
        self._wall_s += perf_counter() - start
        self._reward += reward
        self._unstable |= info["unstable"]
        data, root = self._env.data, self._env.manifest.root_body
        self._hip_m.append(data.body(root).xpos.copy())
        self._head_m.append(float(data.geom("head").xpos[2]))
        self._speeds.append(float(np.abs(data.qvel[self._hinges]).mean()))
        if terminated or truncated:
            self._episodes += 1
            self._env.reset()

    def summary(self) -> Summary:
        """Return what has happened so far, at least one step."""
        steps = len(self._head_m)
        return Summary(
            steps=steps,
            episodes=self._episodes,
            simulated_s=ms_to_s(steps * self._env.manifest.step_ms),
            wall_s=self._wall_s,
            total_reward=self._reward,
            hip_path_m=float(np.linalg.norm(np.diff(self._hip_m, axis=0), axis=1).sum()),
            head_height_m=(min(self._head_m), max(self._head_m)),
            joint_speed_rad_s=float(np.mean(self._speeds)),
            unstable=self._unstable,
        )

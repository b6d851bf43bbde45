"""Run an infant under a policy and summarise the run."""

from collections.abc import Mapping
from dataclasses import dataclass
from time import perf_counter

import mujoco
import numpy as np

from mimoc.kinds import function_of
from mimoc.policies import POLICIES
from mimoc.policies.policy import Policy, PolicyMaker, episode_limit_of, metrics_of
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import FloatArray
from mimoc.units import ms_to_s


@dataclass(frozen=True, slots=True)
class Summary:
    """Summary of a run; everything but the wall time is determined by bundle, policy and seed."""

    steps: int
    """Number of control steps."""
    episodes: int
    """Number of episodes started."""
    simulated_s: float
    wall_s: float
    """Wall time of the simulation, without rendering and printing."""
    total_reward: float
    hip_path_m: float
    """Length of the hip's path."""
    head_height_m: tuple[float, float]
    """Minimum and maximum height of the head's centre above z = 0."""
    joint_speed_rad_s: float
    """Mean absolute joint velocity, over joints and steps."""
    unstable: bool
    """Whether an episode terminated because the simulation became unstable."""
    task: str
    """Kind of the task."""
    finished: int
    """Number of completed episodes."""
    successes: int
    """Number of successful episodes."""
    mean_return: float | None
    """Mean return of the completed episodes; None if there are none."""
    time_to_success_s: float | None
    """Mean simulated time to success; None if there was no success."""
    metrics: Mapping[str, float]
    """What else the policy reports, by name with its unit; see `Policy`."""


def policy_of(env: InfantEnv, policy: str | PolicyMaker) -> Policy:
    """Return a policy for an environment, by its name or from what makes one.

    Raises:
        UnknownNameError: If there is no such policy.
    """
    maker = function_of(POLICIES.find(policy).run, "bind") if isinstance(policy, str) else policy
    return maker(env)


class Run:
    """A run of an environment under a policy, which is stepped and then summarised."""

    def __init__(self, env: InfantEnv, policy: str | PolicyMaker, seed: int):
        """Reset the environment.

        Args:
            env: The environment.
            policy: Name of a policy, or a function from an environment to a policy.
            seed: Seed of both the policy and the reset.

        Raises:
            UnknownNameError: If there is no such policy.
        """
        self.observation, _ = env.reset(seed=seed)  # Policies take their aims from how it starts.
        self.env, self._act = env, policy_of(env, policy)
        self._generator, self._limit = np.random.default_rng(seed), episode_limit_of(self._act)
        self._wall_s, self._reward, self._episodes, self._unstable = 0.0, 0.0, 1, False
        model = env.model
        self._head = env.manifest.anatomy.head or env.manifest.root_body
        self._hinges = model.jnt_dofadr[model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE]
        self._hip_m: list[FloatArray] = []
        self._head_m: list[float] = []
        self._speeds: list[float] = []
        self._earned, self._taken = 0.0, 0
        self._returns: list[float] = []
        self._times_s: list[float] = []

    def step(self) -> None:
        """Take one control step; start a new episode if this one ends."""
        action = self._act(self._generator, self.observation)
        start = perf_counter()
        self.observation, reward, terminated, truncated, info = self.env.step(action)
        self._wall_s += perf_counter() - start
        self._reward += reward
        self._earned, self._taken = self._earned + reward, self._taken + 1
        self._unstable |= info["unstable"]
        data, root = self.env.data, self.env.manifest.root_body
        self._hip_m.append(data.body(root).xpos.copy())
        self._head_m.append(float(data.body(self._head).xipos[2]))
        self._speeds.append(float(np.abs(data.qvel[self._hinges]).mean()))
        if terminated or truncated or self._taken >= self._limit:
            self._end_episode(info["is_success"])
            self.observation, _ = self.env.reset()

    def _end_episode(self, success: bool) -> None:
        self._returns.append(self._earned)
        if success:
            self._times_s.append(ms_to_s(self._taken * self.env.manifest.step_ms))
        self._earned, self._taken = 0.0, 0
        self._episodes += 1

    def summary(self) -> Summary:
        """Return the summary of the steps so far, of which there must be at least one."""
        steps = len(self._head_m)
        return Summary(
            steps=steps,
            episodes=self._episodes,
            simulated_s=ms_to_s(steps * self.env.manifest.step_ms),
            wall_s=self._wall_s,
            total_reward=self._reward,
            task=self.env.manifest.task.kind,
            finished=len(self._returns),
            successes=len(self._times_s),
            mean_return=float(np.mean(self._returns)) if self._returns else None,
            time_to_success_s=float(np.mean(self._times_s)) if self._times_s else None,
            hip_path_m=float(np.linalg.norm(np.diff(self._hip_m, axis=0), axis=1).sum()),
            head_height_m=(min(self._head_m), max(self._head_m)),
            joint_speed_rad_s=float(np.mean(self._speeds)),
            unstable=self._unstable,
            metrics=metrics_of(self._act),
        )

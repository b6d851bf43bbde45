"""Run an infant under a policy and summarise the run."""

from collections.abc import Mapping
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.policies.named import policy_of
from mimoc.policies.policy import Policy, PolicyMaker, begin, episode_limit_of, metrics_of, start_again
from mimoc.quantities.measuring import Outcome, StepMeasures, Value, measure
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.infant import Infant


@dataclass(frozen=True, slots=True)
class Summary:
    """Summary of a run; everything but the wall time is determined by bundle, policy and seed.

    `measures` has all quantities that are measured in `run`; those that mimoc always has are also properties.
    """

    steps: int
    """Number of control steps."""
    episodes: int
    """Number of episodes started."""
    simulated_s: float
    wall_s: float
    """Wall time of the simulation, without rendering and printing."""
    total_reward: float
    task: str
    """Kind of the task."""
    finished: int
    """Number of completed episodes."""
    successes: int
    """Number of successful episodes."""
    measures: Mapping[str, Value]
    """All that is measured of a run, by the name of the quantity; None for a mean of nothing."""
    metrics: Mapping[str, float]
    """What else the policy reports, by name with its unit; see `Policy`."""

    @property
    def mean_return(self) -> float | None:
        """Mean return of the completed episodes; None if there are none."""
        return self.measures["return"]

    @property
    def time_to_success_s(self) -> float | None:
        """Mean simulated time to success; None if there was no success."""
        return self.measures["time_to_success_s"]

    @property
    def hip_path_m(self) -> float:
        """Length of the hip's path."""
        return float(self.measures["hip_path_m"] or 0.0)

    @property
    def head_height_m(self) -> tuple[float, float]:
        """Minimum and maximum height of the head's centre above z = 0."""
        return float(self.measures["head_lowest_m"] or 0.0), float(self.measures["head_height_m"] or 0.0)

    @property
    def joint_speed_rad_s(self) -> float:
        """Mean absolute joint velocity, over joints and steps."""
        return float(self.measures["joint_speed_rad_s"] or 0.0)

    @property
    def unstable(self) -> bool:
        """Whether an episode terminated because the simulation became unstable."""
        return bool(self.measures["unstable"])


class Tally:
    """What one infant did and earned in a run, step by step."""

    def __init__(self, infant: Infant):
        """Begin with an infant that has been reset."""
        self._infant, self._measures, self._outcomes = infant, StepMeasures(infant, "run"), list[Outcome]()
        self._reward, self._steps = 0.0, 0
        self._earned, self._taken = 0.0, 0
        """Of this episode."""

    @property
    def taken(self) -> int:
        """Control steps of this episode."""
        return self._taken

    def add(self, reward: float, info: dict[str, Any]) -> None:
        """Count a control step."""
        self._reward, self._steps = self._reward + reward, self._steps + 1
        self._earned, self._taken = self._earned + reward, self._taken + 1
        self._measures.add(info)

    def end_episode(self, success: bool) -> None:
        """Count an episode."""
        time_s = ms_to_s(self._taken * self._infant.manifest.step_ms)
        self._outcomes.append(Outcome(self._earned, self._taken, success, time_s if success else None))
        self._earned, self._taken = 0.0, 0

    def summary(self, wall_s: float, policy: Policy) -> Summary:
        """Return the summary of the steps so far, of which there must be at least one."""
        manifest = self._infant.manifest
        return Summary(
            steps=self._steps,
            episodes=len(self._outcomes) + 1,
            simulated_s=ms_to_s(self._steps * manifest.step_ms),
            wall_s=wall_s,
            total_reward=self._reward,
            task=manifest.task.kind,
            finished=len(self._outcomes),
            successes=sum(outcome.success for outcome in self._outcomes),
            measures={**measure("episode", "run", self._outcomes), **self._measures.measures()},
            metrics=metrics_of(policy),
        )


class Run:
    """A run of an environment under a policy, which is stepped and then summarised."""

    def __init__(self, env: InfantEnv, policy: str | PolicyMaker, seed: int):
        """Reset the environment.

        Args:
            env: The environment.
            policy: Name of a policy, a sum of names, or a function from an environment to a policy; see `policy_of`.
            seed: Seed of both the policy and the reset.

        Raises:
            UnknownNameError: If there is no such policy.
            PolicyError: If its name lacks something, or it does not fit the infant.
        """
        self.observation, _ = env.reset(seed=seed)  # Policies take their aims from how it starts.
        self.env, self._act = env, policy_of(env, policy)
        self.observation = begin(self._act) or self.observation
        self._generator, self._limit = np.random.default_rng(seed), episode_limit_of(self._act)
        self._tally, self._wall_s = Tally(env), 0.0

    def step(self) -> None:
        """Take one control step; start a new episode if this one ends."""
        action = self._act(self._generator, self.observation)
        start = perf_counter()
        self.observation, reward, terminated, truncated, info = self.env.step(action)
        self._wall_s += perf_counter() - start
        self._tally.add(reward, info)
        if terminated or truncated or self._tally.taken >= self._limit:
            self._tally.end_episode(info["is_success"])
            self.observation, _ = self.env.reset()
            start_again(self._act)
            self.observation = begin(self._act) or self.observation

    def summary(self) -> Summary:
        """Return the summary of the steps so far, of which there must be at least one."""
        return self._tally.summary(self._wall_s, self._act)

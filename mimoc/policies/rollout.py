"""Run the infants of any environment under a policy, step by step, and summarise the run."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from time import perf_counter
from typing import Any

import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.policies.named import Loader, Policies, by_infant, policy_of
from mimoc.policies.policy import Policy, begin, check_apart, episode_limit_of, metrics_of, notes_of, start_again
from mimoc.runtime.batch_env import infants_of
from mimoc.runtime.infant import Infant
from mimoc.runtime.quantities import EpisodeResult, StepMeasures, Value, measure
from mimoc.runtime.sense import Observation

Begun = Mapping[str, tuple[Observation, dict[str, Any]]]
"""What infants observe at the start of an episode, and its info, by name."""
Stepped = Mapping[str, tuple[Observation, float, bool, dict[str, Any]]]
"""What infants observe after a step, rewards, whether their episodes have ended, and infos, by name."""


@dataclass(frozen=True, slots=True)
class Step:
    """One control step of one infant; or the start of its episode, where it has not acted yet."""

    infant: str  # Its name: empty for the only infant of an environment, its number in a vector environment.
    episode: int  # Number of the episode, from 0.
    number: int  # Control steps of the episode so far, 0 at its start.
    observation: Observation  # What it observes after the step.
    action: np.ndarray | None  # What it commanded; None at the start of an episode.
    reward: float
    info: dict[str, Any]
    ended: bool  # Whether this was the last step of the episode.
    total_reward: float  # Sum of the rewards of the episode so far.

    @property
    def success(self) -> bool:
        """Whether the goal is reached."""
        return bool(self.info["is_success"])


def rollout(
    env: Any,
    policy: Policies,
    *,
    steps: int | None = None,
    seconds: float | None = None,
    episodes: int | None = None,
    seed: int = 0,
    steps_per_episode: float | None = None,
    load: Loader | None = None,
) -> Iterator[Step]:
    """Reset an environment, and yield the start of each episode and every control step of each infant.

    With *episodes*, episode e is reset with `seed + e`, and a policy is bound anew and draws from a generator of that
    seed, so that the episode is the same whatever was before. A vector environment goes through them side by side,
    episode e in row e % n. Otherwise only the first reset has a seed, after which policies are bound, and all random
    numbers go on from there: infant i draws from `seed + i`. While a step is looked at, nothing has been reset yet.

    Args:
        env: The environment of one infant, a world, or a vector environment on the CPU, however it is wrapped; the
            wrappers are not used, but for `max_episode_steps`. All infants of a world begin their episodes together.
        policy: A policy for all infants, or policies by infant.
        steps: Control steps after which it stops.
        seconds: The same in simulated time.
        episodes: Episodes after which it stops.
        seed: The first seed.
        steps_per_episode: Control steps after which an episode ends, unless its task ends it earlier; by default as the
            policy says, or `max_episode_steps` of the environment.
        load: Loads trained policies.

    Raises:
        UnknownNameError: If there is no such policy or infant.
        PolicyError: If a policy lacks something, or does not fit its infant.
        TypeError: If it is no environment of mimoc's on the CPU.

    Example:
        >>> import mimoc
        >>> from mimoc.policies.rollout import rollout
        >>> env = mimoc.make("reach.yaml", max_episode_steps=4)
        >>> [step.number for step in rollout(env, "random", episodes=2)]
        [0, 1, 2, 3, 4, 0, 1, 2, 3, 4]
    """
    run = Rollout(env, policy, seed=seed, episodes=episodes, steps_per_episode=steps_per_episode, load=load)
    if seconds is not None:
        steps = round(seconds / ms_to_s(next(iter(run.infants.values())).manifest.step_ms))
    return run.go(math.inf if steps is None else steps)


class Rollout:
    """Infants under a policy, whose control steps are taken one by one; see `rollout`."""

    def __init__(
        self,
        env: Any,
        policy: Policies,
        *,
        seed: int = 0,
        episodes: int | None = None,
        steps_per_episode: float | None = None,
        load: Loader | None = None,
        function: str = "rollout",
    ):
        """Reset the environment; *function* is what a TypeError names."""
        self.infants: dict[str, Infant] = infants_of(function, env)
        self.env: Any = getattr(env, "unwrapped", env)
        self._stage = _stage_of(self.env, self.infants)
        self._seed = seed
        self._episodes = episodes
        self._groups = list[_Group]()
        first = 0
        for number, names in enumerate(self._stage.groups):
            episode = 0 if episodes is None else number
            self._groups.append(_Group(names, first, episode, episodes is None or episode < episodes))
            first += len(names)
        self._generators = dict[str, np.random.Generator]()
        self._returns = dict[str, float]()
        self.observations = dict[str, Observation]()
        """What each infant observes."""
        self._chosen = by_infant(policy, self.infants)
        self._load = load and cache(load)
        # The order matters: aims of policies depend on how the environment starts, and limits on the policies.
        observed = self._stage.reset({group.names: self._seed_of(group, is_first=True) for group in self._groups})
        self.policies = {name: self._bound(name) for name in self.infants}
        limit_of_env = getattr(getattr(env, "spec", None), "max_episode_steps", None) or math.inf
        for group in self._groups:
            limits = [episode_limit_of(self.policies[name]) for name in group.names]
            group.limit = steps_per_episode or min(limit_of_env, *limits)
        self.wall_s = 0.0
        """Wall time of the simulation."""
        self.started = self._begin([group for group in self._groups if group.goes_on], observed)
        """The starts of the first episodes."""

    def _bound(self, name: str) -> Policy:
        return policy_of(self.infants[name], self._chosen[name], self._load)

    def name_of(self, name: str) -> str:
        """Return what an infant is called in its own world; empty for one that is alone there."""
        infant = self.infants[name]
        return next(called for called, other in infant.simulation.infants.items() if other is infant)

    def ends(self, name: str) -> bool:
        """Return whether something ends the episodes of an infant."""
        (limit,) = (group.limit for group in self._groups if name in group.names)
        return limit < math.inf or self.infants[name].max_steps is not None

    def result_of(self, last: Step, path_m: np.ndarray | None = None) -> EpisodeResult:
        """Return the result of the episode that a step has ended."""
        duration_s = ms_to_s(last.number * self.infants[last.infant].manifest.step_ms)
        seed = None if self._episodes is None else self._seed + last.episode
        return EpisodeResult(last.total_reward, last.number, last.success, duration_s, seed, path_m)

    def go(self, steps: float = math.inf) -> Iterator[Step]:
        """Yield the starts of episodes, and so many control steps, or those of all episodes."""
        yield from self.started
        done = 0
        while done < steps and any(group.goes_on for group in self._groups):
            yield from self.advance()
            done += 1
            if done < steps:
                yield from self.renew()

    def advance(self) -> list[Step]:
        """Take one control step of all infants whose episode goes on."""
        going = [group for group in self._groups if group.goes_on]
        actions = {
            name: self.policies[name](self._generators[name], self.observations[name])
            for group in going
            for name in group.acting
        }
        start = perf_counter()
        stepped = self._stage.step(actions)
        self.wall_s += perf_counter() - start
        steps = list[Step]()
        for group in going:
            group.taken += 1
            still_acting = list[str]()
            for name in group.acting:
                observation, reward, ended, info = stepped[name]
                ended = bool(ended or group.taken >= group.limit)
                self.observations[name] = observation
                self._returns[name] += reward
                action = actions[name]
                number = group.taken
                total = self._returns[name]
                steps.append(Step(name, group.episode, number, observation, action, reward, info, ended, total))
                if not ended:
                    still_acting.append(name)
            group.acting = still_acting
        return steps

    def renew(self) -> list[Step]:
        """Begin the next episodes of infants of which all that share a world have ended theirs."""
        over = [group for group in self._groups if group.goes_on and not group.acting]
        for group in over:
            group.episode += 1 if self._episodes is None else len(self._groups)
            group.goes_on = self._episodes is None or group.episode < self._episodes
        if not over or not any(group.goes_on for group in self._groups):
            return []
        observed = self._stage.reset({group.names: self._seed_of(group, is_first=False) for group in over})
        starting = [group for group in over if group.goes_on]
        if self._episodes is not None:
            for group in starting:
                for name in group.names:
                    self.policies[name] = self._bound(name)
        return self._begin(starting, observed)

    def _seed_of(self, group: "_Group", is_first: bool) -> int | None:
        if self._episodes is not None:
            return self._seed + group.episode
        return self._seed + group.first if is_first else None

    def _begin(self, groups: Sequence["_Group"], observed: Begun) -> list[Step]:
        steps = list[Step]()
        for group in groups:
            group.taken = 0
            group.acting = list(group.names)
            seed = self._seed + (group.first if self._episodes is None else group.episode)
            for number, name in enumerate(group.names):
                if self._episodes is not None or name not in self._generators:
                    self._generators[name] = np.random.default_rng(seed + number)
                start_again(self.policies[name])
        begun = [begin(self.policies[name]) for group in groups for name in group.names]
        if any(observation is not None for observation in begun):
            for group in groups:
                check_apart({name: self.infants[name] for name in group.names})
            observed = {name: (self.infants[name].observe(), info) for name, (_, info) in observed.items()}
        for group in groups:
            for name in group.names:
                self.observations[name], info = observed[name]
                self._returns[name] = 0.0
                steps.append(Step(name, group.episode, 0, self.observations[name], None, 0.0, info, False, 0.0))
        return steps


@dataclass(frozen=True, slots=True)
class RunSummary:
    """Summary of one infant's run; everything but the wall time is determined by bundle, policy and seed.

    `measures` has all quantities that are measured in `run`; those that mimoc always has are also properties.
    """

    steps: int  # Number of control steps.
    episodes: int  # Number of episodes started.
    simulated_s: float
    wall_s: float  # Wall time of the simulation, without rendering and printing.
    total_reward: float
    task: str  # Kind of the task.
    finished: int  # Number of completed episodes.
    successes: int  # Number of successful episodes.
    measures: Mapping[str, Value]
    """All that is measured of a run, by the name of the quantity; None for a mean of nothing."""
    metrics: Mapping[str, float]  # What else the policy reports, by name with its unit; see `Policy`.
    notes: tuple[str, ...] = ()  # Sentences that the policy tells of the run.

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


class Run(Rollout):
    """A rollout that is stepped for as long as the caller wants, and then summarised; see `rollout`."""

    def __init__(self, env: Any, policy: Policies, seed: int = 0, load: Loader | None = None):
        """Reset the environment."""
        super().__init__(env, policy, seed=seed, load=load, function="a run")
        self._measures = {name: StepMeasures(infant, "run") for name, infant in self.infants.items()}
        self._results: dict[str, list[EpisodeResult]] = {name: [] for name in self.infants}
        self._steps = dict.fromkeys(self.infants, 0)
        self._rewards = dict.fromkeys(self.infants, 0.0)

    @property
    def observation(self) -> Observation:
        """What the first infant observes."""
        return next(iter(self.observations.values()))

    def step(self) -> None:
        """Take one control step; begin the next episodes of infants whose episodes have ended."""
        for step in self.advance():
            self._steps[step.infant] += 1
            self._rewards[step.infant] += step.reward
            self._measures[step.infant].add(step.info)
            if step.ended:
                self._results[step.infant].append(self.result_of(step))
        self.renew()

    def summary(self) -> RunSummary:
        """Return the summary of the first infant's steps so far, of which there must be at least one."""
        return self._summary(next(iter(self.infants)))

    def summaries(self) -> dict[str, RunSummary]:
        """Return the summary of each infant's steps so far, of which there must be at least one."""
        return {name: self._summary(name) for name in self.infants}

    def _summary(self, name: str) -> RunSummary:
        manifest = self.infants[name].manifest
        results = self._results[name]
        return RunSummary(
            steps=self._steps[name],
            episodes=len(results) + 1,
            simulated_s=ms_to_s(self._steps[name] * manifest.step_ms),
            wall_s=self.wall_s,
            total_reward=self._rewards[name],
            task=manifest.task.kind,
            finished=len(results),
            successes=sum(result.success for result in results),
            measures={**measure("episode", "run", results), **self._measures[name].measures()},
            metrics=metrics_of(self.policies[name]),
            notes=notes_of(self.policies[name]),
        )


@dataclass(slots=True)
class _Group:
    """Infants that begin their episodes together."""

    names: tuple[str, ...]
    first: int  # Number of its first infant among all.
    episode: int
    goes_on: bool  # Whether an episode of it goes on or is still to come.
    limit: float = math.inf
    taken: int = 0  # Control steps of this episode.
    acting: list[str] = field(default_factory=list)  # Infants whose episode goes on.


class _Alone:
    """An environment of one infant, as it is run: values are by name of the infant, groups are those in one world."""

    groups = (("",),)

    def __init__(self, env: Any):
        self._env = env

    def reset(self, seeds: Mapping[tuple[str, ...], int | None]) -> Begun:
        return {"": self._env.reset(seed=seeds["",])}

    def step(self, actions: Mapping[str, np.ndarray]) -> Stepped:
        observation, reward, terminated, truncated, info = self._env.step(actions[""])
        return {"": (observation, reward, terminated or truncated, info)}


class _World:
    """An environment of infants in one world, as it is run; see `_Alone`."""

    def __init__(self, world: Any):
        self._world = world
        self.groups = (tuple(world.infants),)

    def reset(self, seeds: Mapping[tuple[str, ...], int | None]) -> Begun:
        observations, infos = self._world.reset(seed=seeds[self.groups[0]])
        return {name: (observations[name], infos[name]) for name in observations}

    def step(self, actions: Mapping[str, np.ndarray]) -> Stepped:
        observations, rewards, terminated, truncated, infos = self._world.step(actions)
        return {
            name: (observations[name], rewards[name], terminated[name] or truncated[name], infos[name])
            for name in actions
        }


class _Rows:
    """A vector environment, as it is run, with one or several infants in each of its worlds; see `_Alone`."""

    def __init__(self, envs: Any, infants: Mapping[str, Infant]):
        self._envs = envs
        self._names = tuple(infants)
        worlds = dict[int, tuple[str, ...]]()
        for name, infant in infants.items():
            worlds[id(infant.simulation)] = (*worlds.get(id(infant.simulation), ()), name)
        self.groups = tuple(worlds.values())
        self._rest = np.clip(0.0, envs.action_space.low, envs.action_space.high).astype(np.float32)

    def reset(self, seeds: Mapping[tuple[str, ...], int | None]) -> Begun:
        by_row = {
            name: None if seed is None else seed + number
            for names, seed in seeds.items()
            for number, name in enumerate(names)
        }
        rows = [by_row.get(name) for name in self._names]
        mask = np.array([name in by_row for name in self._names])
        observations, infos = self._envs.reset(seed=rows, options={"reset_mask": mask})
        return {
            name: ({sense: readings[row] for sense, readings in observations.items()}, info_of(infos, row))
            for row, name in enumerate(self._names)
            if mask[row]
        }

    def step(self, actions: Mapping[str, np.ndarray]) -> Stepped:
        joined = self._rest.copy()
        for row, name in enumerate(self._names):
            if name in actions:
                joined[row] = actions[name]
        observations, rewards, terminated, truncated, infos = self._envs.step(joined)
        stepped = {}
        for row, name in enumerate(self._names):
            info = info_of(infos, row)
            last = {sense: readings[row] for sense, readings in observations.items()}
            if "final_info" in info:  # It was reset in the same step.
                last = info["final_obs"]
                info = info["final_info"]
            stepped[name] = last, float(rewards[row]), bool(terminated[row] or truncated[row]), info
        return stepped


def _stage_of(env: Any, infants: Mapping[str, Infant]) -> _Alone | _World | _Rows:
    if "" in infants:
        return _Alone(env)
    return _Rows(env, infants) if hasattr(env, "num_envs") else _World(env)


def info_of(infos: Mapping[str, Any], row: int) -> dict[str, Any]:
    """Return the info of one row of a vector environment."""
    return {
        name: info_of(values, row) if isinstance(values, Mapping) else _item(values[row])
        for name, values in infos.items()
        if f"_{name}" in infos and infos[f"_{name}"][row]
    }


def _item(value: Any) -> Any:
    return value.item() if isinstance(value, np.generic) else value

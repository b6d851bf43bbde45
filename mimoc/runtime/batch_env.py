"""The Gymnasium vector environment of many infants."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv

from mimoc.base.classes import described
from mimoc.render.picture_files import Picture, in_rows
from mimoc.render.renderer import SharedRenderers, sharing
from mimoc.runtime.batch import Batch
from mimoc.runtime.closing import closable
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing import SEED
from mimoc.runtime.gymnasium_forms import (
    InfantVectorEnv,
    Infos,
    arousals_of,
    check_mixture,
    joined_infos,
    options_of,
    refuse_ended,
    reset_indices,
    seeds_of,
)
from mimoc.runtime.infant import AGE, Infant
from mimoc.runtime.sense import FloatArray, Observation
from mimoc.runtime.simulation import AgeSchedule, Simulation
from mimoc.runtime.world_env import WorldEnv

Opened = InfantEnv | WorldEnv
SteppedEach = tuple[Observation, FloatArray, npt.NDArray[np.bool_], npt.NDArray[np.bool_], Infos]
Stepped = tuple[Observation, FloatArray, npt.NDArray[np.bool_], npt.NDArray[np.bool_], dict[str, Any]]


@closable("call", "get_attr", "seek")
class BatchEnv(InfantVectorEnv, VectorEnv[Any, Any, Any]):  # skrl looks for it among direct bases.
    """A vector environment of infants on the CPU: each in a world of its own, or several in each world.

    Infant i has, step for step and bit for bit, the observations and rewards of its world alone with the same seed:
    `infants[i]` is that infant. They may be of different ages, strengths and scenes, and may grow by a schedule. In
    worlds of several, all episodes of a world end together: when that of one infant ends, the others' are truncated.
    """

    def __init__(
        self,
        openers: Sequence[Callable[[], Opened]],
        threads: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        max_episode_steps: int | None = None,
        schedule: AgeSchedule | None = None,
    ):
        """Open environments and join them; the eyes of all share OpenGL contexts.

        Raises:
            BatchMismatchError: If they do not sense and command the same.
        """
        self.closed = True  # Not open yet: older versions of Gymnasium close what could not be made, too.
        self._renderers = SharedRenderers()
        with sharing(self._renderers):
            self._envs = tuple(open_env() for open_env in openers)
        simulations = [env.simulation for env in self._envs]
        check_mixture([infant for world in simulations for infant in world.infants.values()])
        self._batch = Batch(simulations, threads)
        self.render_mode = self._envs[0].render_mode
        self._max_steps = max_episode_steps
        spaces = [infant.observation_space for infant in self.infants]
        self._describe(self._envs[0].metadata, self.infants, spaces, AutoresetMode(autoreset_mode), max_episode_steps)
        self._ended = np.zeros(self.num_envs, bool)
        self.closed = False
        if schedule:
            self.grow_by(schedule)

    @property
    def infants(self) -> tuple[Infant, ...]:
        """The infants, a row each, in the order of worlds and of infants in them."""
        return self._batch.infants

    @property
    def simulations(self) -> tuple[Simulation, ...]:
        """The worlds."""
        return self._batch.simulations

    @property
    def steps_done(self) -> npt.NDArray[np.int_]:
        """Control steps that each infant has taken, by which those grow that have a schedule, shape (n,)."""
        return np.array([infant.simulation.steps_done for infant in self.infants])

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # pyright: ignore[reportIncompatibleMethodOverride] - One for each.
        """The seed of each infant's random numbers."""
        return self.get_attr("np_random_seed")

    @property
    def np_random(self) -> Any:  # pyright: ignore[reportIncompatibleMethodOverride] - A generator for each.
        """The random numbers of each infant."""
        return self.get_attr("np_random")

    @property
    def threads(self) -> int:
        """How many threads the physics is shared among."""
        return self._batch.physics.threads

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start an episode of each infant, or of those in the option `reset_mask`.

        Args:
            seed: Infant i is reset with `seed + i`, or with the i-th of a list.
            options: Those of `InfantEnv.reset`; a value is for all infants, or, as a list or an array, one for each,
                where None is none.
        """
        count = self.num_envs
        which = reset_indices(options, count)
        observation, infos = self.reset_each(seeds_of(seed, count), options_of(options, count), which)
        return observation, joined_infos(infos, self.num_envs)

    def reset_each(
        self, seeds: Sequence[int | None], options: Sequence[dict[str, Any]], which: Sequence[int] | None = None
    ) -> tuple[Observation, Infos]:
        """Reset some infants, or all, each with its own seed and options; see `reset`."""
        worlds = range(len(self._envs)) if which is None else {self._batch.world_of[row]: None for row in which}
        infos: Infos = {}
        for world in worlds:
            infos |= {row: info for row, (_, info) in self._reset_world(world, seeds, options).items()}
        self._batch.refresh()
        return self._batch.observe(), infos

    def step(self, actions: npt.NDArray[np.float32]) -> Stepped:
        """Apply an action of each infant, shape (n, actuators), for one control step, clipped to the action space.

        Infants whose episode has ended are reset instead; with `Disabled` resets, `ResetNeeded` is raised.
        """
        observation, rewards, terminated, truncated, infos = self.step_each(actions)
        return observation, rewards, terminated, truncated, joined_infos(infos, self.num_envs)

    def step_each(self, actions: npt.NDArray[Any]) -> SteppedEach:
        """Make a step as `step` does, with an info for each infant; those whose age is due grow before it."""
        actions = self._checked(actions)
        infos = dict[int, dict[str, Any]]()
        rewards = np.zeros(self.num_envs)
        terminated = np.zeros(self.num_envs, bool)
        truncated, batch = terminated.copy(), self._batch
        if self.autoreset_mode == AutoresetMode.DISABLED:
            refuse_ended(self._ended)
        ended = {batch.world_of[row]: None for row in np.flatnonzero(self._ended)}
        going = [world for world in batch.order if world not in ended]
        with sharing(self._renderers):
            for world in going:
                batch.simulations[world].grow_as_scheduled()
                batch.simulations[world].steps_done += 1
        batch.refresh()
        rows = [row for world in going for row in batch.rows_of[world].values()]
        infants = batch.infants
        observed = {row: infants[row].observer for row in rows if infants[row].observer.keeps}
        for observer in observed.values():
            observer.stepping()
        batch.step(actions, rows)
        unstable, judged = batch.are_unstable(), {}
        for row in rows:
            infant = infants[row]
            rewards[row], terminated[row], truncated[row], infos[row] = infant.judge(
                actions[row], unstable=unstable[row]
            )
            if self._max_steps is not None and infant.steps >= self._max_steps:
                truncated[row] = True
            if row in observed:
                judged[row] = float(rewards[row]), bool(terminated[row]), bool(truncated[row]), infos[row]
        for world in ended:
            infos |= {row: info for row, (_, info) in self._reset_world(world).items()}
        batch.refresh()
        observation = batch.observe()
        for row in rows:
            for readings in observation.values() if unstable[row] else ():
                np.nan_to_num(readings[row], copy=False)
        for row, observer in observed.items():
            seen = {name: readings[row] for name, readings in observation.items()}
            observer.stepped(actions[row], seen, judged[row])
        self._end_together(terminated, truncated)
        if self.autoreset_mode == AutoresetMode.SAME_STEP:
            self._reset_ended(observation, infos)
        return observation, rewards, terminated, truncated, infos

    def _end_together(self, terminated: npt.NDArray[np.bool_], truncated: npt.NDArray[np.bool_]) -> None:
        self._ended = terminated | truncated
        for world in {self._batch.world_of[row] for row in np.flatnonzero(self._ended)}:
            rows = list(self._batch.rows_of[world].values())
            truncated[rows] |= ~self._ended[rows]
            self._ended[rows] = True

    def grow(self, to: float | Sequence[float | None] | npt.NDArray[Any]) -> Observation:
        """Let infants have other ages from now on, in months: one for all, or one each; None keeps the present age."""
        options = options_of({AGE: to}, self.num_envs)
        with sharing(self._renderers):
            for world, simulation in enumerate(self.simulations):
                ages = {name: options[row][AGE] for name, row in self._batch.rows_of[world].items() if options[row]}
                simulation.grow(ages)
        self._batch.refresh()
        return self._batch.observe()

    def grow_by(self, schedule: AgeSchedule) -> None:
        """Let all infants grow by a schedule from now on, as by `mimoc.GrowthWrapper`; a reset must follow."""
        for world in self.simulations:
            world.grow_by(dict.fromkeys(world.infants, schedule))

    def set_arousal(self, levels: float | Sequence[float] | npt.NDArray[Any]) -> None:
        """Change the arousal, from 0 to 2, of all infants or of each, for the rest of their episodes."""
        for infant, level in zip(self.infants, arousals_of(levels, self.num_envs), strict=True):
            infant.set_arousal(level)

    def seek(self, steps_done: int) -> None:
        """Set the number of control steps by which infants grow, for a resumed training; a reset must follow."""
        for world in self.simulations:
            world.steps_done = steps_done

    def render(self) -> Picture | None:  # pyright: ignore[reportIncompatibleMethodOverride] - One picture of all.
        """Return a picture of all worlds, in render mode `rgb_array`; `call("render")` returns one for each infant."""
        pictures: list[Any] = [env.render() for env in self._envs]
        return in_rows(pictures) if self.render_mode == "rgb_array" else None

    def call(self, name: str, *arguments: Any, **keywords: Any) -> tuple[Any, ...]:
        """Return what a method of each infant returns, or an attribute of each."""
        attributes = [getattr(infant, name) for infant in self.infants]
        return tuple(item(*arguments, **keywords) if callable(item) else item for item in attributes)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return an attribute of each infant."""
        return tuple(getattr(infant, name) for infant in self.infants)

    def set_attr(self, name: str, values: Any) -> None:
        """Set an attribute of each infant, from a list or tuple of values, or to one value."""
        values = values if isinstance(values, (list, tuple)) else [values] * self.num_envs
        for infant, value in zip(self.infants, values, strict=True):
            setattr(infant, name, value)

    def get_state(self) -> list[dict[str, Any]]:
        """Return the state of each infant that is alone, see `InfantEnv.get_state`, or of each world of several."""
        return [env.get_state() if isinstance(env, InfantEnv) else env.simulation.get_state() for env in self._envs]

    def set_state(self, states: Sequence[dict[str, Any]]) -> Observation:
        """Restore the state of each world; return what the infants observe.

        Raises:
            ValueError: If there are not as many states as worlds, or one is that of a different infant; nothing has
                changed then.
        """
        if not isinstance(states, (list, tuple)) or len(states) != len(self._envs):
            whom = "infant" if len(self._envs) == self.num_envs else "world"
            raise ValueError(f"expected a list of {len(self._envs)} states, one for each {whom}")
        before = self.get_state()
        try:
            self._set_states(states)
        except Exception:
            self._set_states(before)
            self._batch.refresh()
            raise
        self._ended[:] = False
        self._batch.refresh()
        return self._batch.observe()

    def _set_states(self, states: Sequence[dict[str, Any]]) -> None:
        for env, state in zip(self._envs, states, strict=True):
            (env if isinstance(env, InfantEnv) else env.simulation).set_state(state)

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: value for name, value in self.__dict__.items() if name not in BOUND}
        return {**kept, "envs": [(type(env), env.__getstate__()) for env in self._envs], "threads": self.threads}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        envs, threads = kept.pop("envs"), kept.pop("threads")
        self.__dict__.update(kept)
        self._renderers = SharedRenderers()
        with sharing(self._renderers):
            self._envs = tuple(_restored(*env) for env in envs)
        self._batch = Batch([env.simulation for env in self._envs], threads)
        self.closed = False

    def close_extras(self, **kwargs: Any) -> None:
        """Close all infants and end the threads; see `InfantEnv.close` for what can still be read."""
        self._batch.physics.close()
        for env in self._envs:
            env.close()
        self._renderers.close()

    def _reset_world(
        self, world: int, seeds: Sequence[int | None] | None = None, options: Sequence[dict[str, Any]] | None = None
    ) -> dict[int, tuple[Observation, dict[str, Any]]]:
        """Start an episode of a world with the seeds and options of its rows; return observation and info by row."""
        rows = self._batch.rows_of[world]
        simulation = self.simulations[world]
        given = {name: dict(options[row]) if options else {} for name, row in rows.items()}
        scenes = [] if "" in given else [asked.pop(SEED) for asked in given.values() if SEED in asked]
        with sharing(self._renderers):
            started = simulation.reset(
                {name: seeds[row] if seeds else None for name, row in rows.items()}, given, *scenes[:1]
            )
        self._ended[list(rows.values())] = False
        return {rows[name]: start for name, start in started.items()}

    def _reset_ended(self, observation: Observation, infos: Infos) -> None:
        """Reset the worlds whose episodes have just ended, and replace what their infants observe."""
        for world in dict.fromkeys(self._batch.world_of[row] for row in np.flatnonzero(self._ended)):
            for row, (first, info) in self._reset_world(world).items():
                final = {name: readings[row].copy() for name, readings in observation.items()}
                infos[row] = {"final_obs": final, "final_info": infos[row], **info}
                for name, reading in first.items():
                    observation[name][row] = reading
        self._batch.refresh()


BOUND = {"closed", "_envs", "_renderers", "_batch"}  # Attributes that are not copied but made anew.


def _restored(kind: type[Opened], kept: dict[str, Any]) -> Opened:
    env = kind.__new__(kind)
    env.__setstate__(kept)
    return env


def infants_of(function: str, env: Any) -> dict[str, Infant]:
    """Return the infants of an environment on the CPU, by name.

    The name of the only infant is empty; infants of a world have their own names, and those of a vector environment
    their numbers, from 0. The error of any other environment names the *function* that was called.
    """
    inside = getattr(env, "unwrapped", env)
    if isinstance(inside, InfantEnv):
        return {"": inside}
    if isinstance(inside, WorldEnv):
        return dict(inside.infants)
    if isinstance(inside, BatchEnv):
        return {str(number): infant for number, infant in enumerate(inside.infants)}
    several = [env.unwrapped for env in getattr(inside, "envs", ())]
    if several and all(isinstance(infant, InfantEnv) for infant in several):
        return {str(number): infant for number, infant in enumerate(several)}
    raise TypeError(f"{function}: expected an environment of mimoc's on the CPU, got {described(inside)}")

"""The Gymnasium vector environment of many infants."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.vector import AutoresetMode, VectorEnv

from mimoc.delays.schedule import arrived
from mimoc.render.picture_files import Picture, in_rows
from mimoc.render.renderer import SharedRenderers, sharing
from mimoc.runtime.batch.control_step import ControlStep
from mimoc.runtime.batch.gymnasium_forms import (
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
from mimoc.runtime.batch.physics import ThreadedPhysics
from mimoc.runtime.batch.senses import BatchSense
from mimoc.runtime.closing import closable
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.growing import AGE
from mimoc.senses.sense import FloatArray, Observation

SteppedEach = tuple[Observation, FloatArray, npt.NDArray[np.bool_], npt.NDArray[np.bool_], Infos]
Stepped = tuple[Observation, FloatArray, npt.NDArray[np.bool_], npt.NDArray[np.bool_], dict[str, Any]]


@closable("call", "get_attr", "seek")
class BatchEnv(InfantVectorEnv, VectorEnv[Any, Any, Any]):  # skrl looks for it among direct bases.
    """Infants that live side by side, each in a world of its own.

    Infant i observes and earns, step for step and bit for bit, what it would alone with the same seed: `infants[i]` is
    its `InfantEnv`, whose physics, senses and signals are worked through together with those of the others. They may
    be of different ages, strengths and scenes. With a schedule of growth, each lives as alone in a `GrowthWrapper`.
    """

    def __init__(
        self,
        openers: Sequence[Callable[[], InfantEnv]],
        threads: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        max_episode_steps: int | None = None,
        schedule: Callable[[int], float] | None = None,
    ):
        """Open infants and join them.

        Args:
            openers: What opens each, at least one; their eyes share OpenGL contexts.
            threads: How many to use, or all that this process may use.
            autoreset_mode: When an infant whose episode has ended is reset; see Gymnasium.
            max_episode_steps: Control steps after which any episode is truncated, as by Gymnasium's `TimeLimit`.
            schedule: From the number of control steps that an infant has taken to its age in months, if they grow.

        Raises:
            MixtureError: If they do not sense and command the same.
        """
        self.closed = True  # Not open yet: older versions of Gymnasium close what could not be made, too.
        self._renderers, self.num_envs = SharedRenderers(), len(openers)
        with sharing(self._renderers):
            infants = self.infants = tuple(open_infant() for open_infant in openers)
        check_mixture(infants)
        self.render_mode = infants[0].render_mode
        spaces = [infant.observation_space for infant in infants]
        self._describe(infants, spaces, AutoresetMode(autoreset_mode), max_episode_steps)
        self._ended, self._max_steps = np.zeros(self.num_envs, bool), max_episode_steps
        self._schedule, self.steps_done = schedule, np.zeros(self.num_envs, int)
        self._physics = _physics_of(infants, threads)
        self._bind()
        self.closed = False

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
        return self._physics.threads

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start an episode of each infant, or of those in the option `reset_mask`.

        Args:
            seed: Infant i is reset with `seed + i`, or with the i-th of a list.
            options: Those of `InfantEnv.reset`; a value is for all infants, or, as a list or an array, one for each,
                where None is none.

        Raises:
            UnknownNameError: If there is no such pose or option.
            ValueError: If a seed is not a non-negative integer, or a list has not one value for each infant.
        """
        count = self.num_envs
        which = reset_indices(options, count)
        observation, infos = self.reset_each(seeds_of(seed, count), options_of(options, count), which)
        return observation, joined_infos(infos, self.num_envs)

    def reset_each(
        self, seeds: Sequence[int | None], options: Sequence[dict[str, Any]], which: Sequence[int] | None = None
    ) -> tuple[Observation, Infos]:
        """Reset some infants, or all, each with its own seed and options; see `reset`."""
        infos: Infos = {}
        for infant in range(self.num_envs) if which is None else which:
            _, infos[infant] = self._reset_one(infant, seeds[infant], options[infant])
            self._ended[infant] = False
        self._refresh_models()
        return self._observe(), infos

    def step(self, actions: npt.NDArray[np.float32]) -> Stepped:
        """Apply an action of each infant for one control step; those whose episode has ended are reset instead.

        Args:
            actions: Shape (n, actuators); values outside the action space are clipped.

        Raises:
            ValueError: If the actions have the wrong shape or are not finite.
            ResetNeeded: If an episode has ended, and the autoreset mode leaves it to the caller to reset the infant.
        """
        observation, rewards, terminated, truncated, infos = self.step_each(actions)
        return observation, rewards, terminated, truncated, joined_infos(infos, self.num_envs)

    def step_each(self, actions: npt.NDArray[Any]) -> SteppedEach:
        """Make a step as `step` does, with the info of each infant by itself; those whose age is due grow before it."""
        actions, infos = self._checked(actions), dict[int, dict[str, Any]]()
        rewards, terminated = np.zeros(self.num_envs), np.zeros(self.num_envs, bool)
        truncated, unstable = terminated.copy(), []
        if self.autoreset_mode == AutoresetMode.DISABLED:
            refuse_ended(self._ended)
        anew = np.flatnonzero(self._ended).tolist()
        for infant in np.flatnonzero(~self._ended).tolist():
            self._grow_one(infant, self._age_due(infant))
            self.steps_done[infant] += 1
        self._refresh_models()
        going = [infant for infant in self._order if not self._ended[infant]]
        observed = [infant for infant in going if self.infants[infant].observer.keeps]
        for infant in observed:
            self.infants[infant].observer.stepping()
        self._control_step(actions, going)
        broken = self._physics.are_unstable()
        for infant in going:
            judged = self.infants[infant].judge(actions[infant], unstable=broken[infant])
            rewards[infant], terminated[infant], truncated[infant], infos[infant] = judged
            if broken[infant]:
                unstable.append(infant)
            if self._max_steps is not None and self.infants[infant].steps >= self._max_steps:
                truncated[infant] = True
        for infant in anew:
            infos[infant] = self._reset_one(infant)[1]
        self._refresh_models()
        observation = self._observe()
        for readings in observation.values():
            for infant in unstable:
                np.nan_to_num(readings[infant], copy=False)
        for infant in observed:
            judged = float(rewards[infant]), bool(terminated[infant]), bool(truncated[infant]), infos[infant]
            seen = {name: readings[infant] for name, readings in observation.items()}
            self.infants[infant].observer.stepped(actions[infant], seen, judged)
        self._ended = terminated | truncated
        if self.autoreset_mode == AutoresetMode.SAME_STEP:
            self._reset_ended(observation, infos)
        return observation, rewards, terminated, truncated, infos

    def grow(self, to: float | Sequence[float | None] | npt.NDArray[Any]) -> Observation:
        """Let infants have other ages from now on, in the midst of their episodes; return what they observe.

        Args:
            to: The new age of all, in months, or, as a list or an array, one for each, where None is as old as now.

        Raises:
            ValueError: If an age is none from 0 to 24 months, or a list has not one value for each infant.
            MimocError: If there is no such infant; those before it have grown.
        """
        for infant, options in enumerate(options_of({AGE: to}, self.num_envs)):
            self._grow_one(infant, options)
        self._refresh_models()
        return self._observe()

    def set_arousal(self, levels: float | Sequence[float] | npt.NDArray[Any]) -> None:
        """Change the arousal of infants for the rest of their episodes; see `InfantEnv.set_arousal`.

        Args:
            levels: That of all, or, as a list or an array, one for each.

        Raises:
            ValueError: If one is none from 0 to 2, or a list has not one for each; nothing has changed then.
        """
        for infant, level in zip(self.infants, arousals_of(levels, self.num_envs), strict=True):
            infant.set_arousal(level)

    def seek(self, steps_done: int) -> None:
        """Go on as after a number of control steps of each, as a training does that is resumed; a reset must follow."""
        self.steps_done[:] = steps_done

    def _grow_one(self, infant: int, options: dict[str, Any]) -> None:
        """Let an infant grow if options give it an age."""
        if options:
            with sharing(self._renderers):
                self.infants[infant].grow(to=options[AGE])

    def _age_due(self, infant: int) -> dict[str, Any]:
        """Return the age that the schedule gives an infant now, as an option, if it has another."""
        due = self._schedule(int(self.steps_done[infant])) if self._schedule else None
        return {} if due in (None, self.infants[infant].age_months) else {AGE: due}

    def render(self) -> Picture | None:  # pyright: ignore[reportIncompatibleMethodOverride] - One picture of all.
        """Return a picture of all infants in rows, in render mode `rgb_array`, otherwise None.

        `call("render")` returns those of the single infants.

        Raises:
            RenderingError: If OpenGL is not available.
        """
        return in_rows(self.call("render")) if self.render_mode == "rgb_array" else None

    def call(self, name: str, *arguments: Any, **keywords: Any) -> tuple[Any, ...]:
        """Return what a method of each infant returns, or an attribute of each."""
        attributes = [getattr(infant, name) for infant in self.infants]
        return tuple(item(*arguments, **keywords) if callable(item) else item for item in attributes)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return an attribute of each infant."""
        return tuple(getattr(infant, name) for infant in self.infants)

    def set_attr(self, name: str, values: Any) -> None:
        """Set an attribute of each infant, to its value of a list or a tuple, or to the same value.

        Raises:
            ValueError: If a list has not one value for each.
        """
        values = values if isinstance(values, (list, tuple)) else [values] * self.num_envs
        for infant, value in zip(self.infants, values, strict=True):
            setattr(infant, name, value)

    def get_state(self) -> list[dict[str, Any]]:
        """Return the state of each infant; see `InfantEnv.get_state`."""
        return [infant.get_state() for infant in self.infants]

    def set_state(self, states: Sequence[dict[str, Any]]) -> Observation:
        """Restore the state of each infant, whose episode has not ended; return what they observe.

        Raises:
            ValueError: If there are not as many states as infants, or one is that of a different infant; nothing has
                changed then.
        """
        if not isinstance(states, (list, tuple)) or len(states) != self.num_envs:
            raise ValueError(f"expected a list of {self.num_envs} states, one for each infant")
        before = self.get_state()
        try:
            self._set_states(states)
        except Exception:
            self._set_states(before)
            self._refresh_models()
            raise
        self._ended[:] = False
        self._refresh_models()
        return self._observe()

    def _set_states(self, states: Sequence[dict[str, Any]]) -> None:
        for infant, state in zip(self.infants, states, strict=True):
            infant.set_state(state)

    def __getstate__(self) -> dict[str, Any]:
        """Support copying and pickling: each infant as it is kept alone, so that the copy goes on as this would."""
        kept = {name: value for name, value in self.__dict__.items() if name not in BOUND}
        infants = [(type(infant), infant.__getstate__()) for infant in self.infants]
        return {**kept, "infants": infants, "threads": self._physics.threads}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        """Open the same infants again in their states; the eyes of the copy share OpenGL contexts of its own."""
        infants, threads = kept.pop("infants"), kept.pop("threads")
        self.__dict__.update(kept)
        self._renderers = SharedRenderers()
        with sharing(self._renderers):
            self.infants = tuple(_restored(*infant) for infant in infants)
        self._physics = _physics_of(self.infants, threads)
        self._bind()
        self.closed = False

    def close_extras(self, **kwargs: Any) -> None:
        """Close all infants and end the threads; what can still be read then is said at `InfantEnv.close`."""
        self._physics.close()
        for infant in self.infants:
            infant.close()
        self._renderers.close()

    def _bind(self) -> None:
        """Join what all infants have now; those of one bundle are worked through one after another."""
        firsts = {id(infant.bundle): index for index, infant in reversed(list(enumerate(self.infants)))}
        self._order = sorted(range(self.num_envs), key=lambda index: firsts[id(self.infants[index].bundle)])
        self._senses = {
            name: BatchSense(name, [infant.senses[name] for infant in self.infants], self._physics)
            for name in self.infants[0].senses
        }
        schedules = [infant.schedule for infant in self.infants]
        self._delayed = {name: [schedule.samples[name] for schedule in schedules] for name in self._senses}
        self._control_step = ControlStep(self.infants, self._physics, self._senses)

    def _refresh_models(self) -> None:
        """Take over what infants have now that got another model, in another scene or by growing."""
        pairs = enumerate(zip(self.infants, self._physics.models, self._physics.datas, strict=True))
        changed = [
            index for index, (infant, model, data) in pairs if infant.data is not data or infant.model is not model
        ]
        for index in changed:
            self._physics.replace(index, self.infants[index].model, self.infants[index].data)
        if changed:
            self._bind()

    def _observe(self) -> Observation:
        """Return what all infants observe, as new arrays."""
        observation: Observation = {}
        for name, sense in self._senses.items():
            observation.update(sense.observe([arrived(delayed) for delayed in self._delayed[name]]))
        if self.infants[0].task.spaces:
            views = [infant.task.observe() for infant in self.infants]
            observation |= {name: np.stack([view[name] for view in views]) for name in views[0]}
        return observation

    def _reset_one(
        self, infant: int, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Start an episode of one infant, at the age that is due unless the option `age_months` gives another."""
        with sharing(self._renderers):
            return self.infants[infant].reset(seed=seed, options={**self._age_due(infant), **(options or {})})

    def _reset_ended(self, observation: Observation, infos: Infos) -> None:
        """Reset the infants whose episodes have just ended, and put what they observe then in its place."""
        for infant in np.flatnonzero(self._ended).tolist():
            final = {name: readings[infant].copy() for name, readings in observation.items()}
            first, info = self._reset_one(infant)
            infos[infant] = {"final_obs": final, "final_info": infos[infant], **info}
            for name, reading in first.items():
                observation[name][infant] = reading
        self._ended[:] = False


BOUND = {"infants", "closed", "_renderers", "_physics", "_senses", "_delayed", "_control_step", "_order"}
"""Attributes that are not copied but made anew."""


def _physics_of(infants: Sequence[InfantEnv], threads: int | None) -> ThreadedPhysics:
    return ThreadedPhysics([infant.model for infant in infants], [infant.data for infant in infants], threads)


def _restored(kind: type[InfantEnv], kept: dict[str, Any]) -> InfantEnv:
    """Return the infant that was kept."""
    infant = kind.__new__(kind)
    infant.__setstate__(kept)
    return infant

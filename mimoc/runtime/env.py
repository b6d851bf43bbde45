"""The Gymnasium environment around a compiled infant."""

import copy
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal

import gymnasium
import mujoco
import numpy as np
import numpy.typing as npt
from gymnasium.envs.registration import EnvSpec

from mimoc.actuation.binding import bind_actuation
from mimoc.actuation.voice import Voice
from mimoc.base.classes import described
from mimoc.base.random_streams import checked_seed
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import bounded, is_unstable
from mimoc.bundle.variants import Variant, Variants, open_variant
from mimoc.companions.binding import bind_companions
from mimoc.delays.schedule import Schedule
from mimoc.delays.timing import timing_of
from mimoc.noise.noise import NoiseStreams
from mimoc.render.environment import MODES, EnvRenderer, available_modes, check_rendering
from mimoc.runtime import growing
from mimoc.runtime.closing import closable
from mimoc.runtime.infant_view import InfantView
from mimoc.runtime.observer import NO_OBSERVER
from mimoc.runtime.simulation_state import SimulationState
from mimoc.runtime.spaces import action_space, check_same_space, observation_space, with_limit
from mimoc.senses.binding import bind_senses
from mimoc.senses.custom import by_name
from mimoc.senses.sense import Observation, Sense
from mimoc.tasks.task import bind_task


@closable()
class InfantEnv(InfantView, gymnasium.Env[Any, npt.NDArray[np.float32]]):
    """An infant in its scene.

    Observation: a dictionary with one float32 array for each of proprioception, vestibular sense and touch, and one
    uint8 image, shape (H, W, 3), for each eye; an infant without senses observes `nothing`, a single zero.
    Action: a Box with one command for each commanded actuator.
    Reward and termination are those of the bundle's task, and episodes are truncated after the task's number of steps;
    without a task the reward is zero and episodes do not end. An episode also terminates if the simulation becomes
    unstable. `info` contains `is_success`, the terms of the reward as `reward_terms`, and `unstable`.
    """

    metadata = {"render_modes": [*MODES], "render_fps": 100}  # noqa: RUF012 - Gymnasium's own attribute.
    closed = False
    _spec: EnvSpec | None = None

    def __init__(
        self,
        bundle: Bundle | Variant | str | Path,
        render_mode: Literal["human", "rgb_array"] | None = None,
        width: int = 480,
        height: int = 480,
        variants: Variants | None = None,
        task: Any = None,
        senses: Mapping[str, Any] = MappingProxyType({}),
        companions: Mapping[str, Any] = MappingProxyType({}),
    ):
        """Open a bundle.

        Args:
            bundle: A bundle, or a bundle folder; or one with its model.
            render_mode: `human` for a window that is updated at every step, `rgb_array` for images from `render()`.
            width: Width of the images, in pixels.
            height: Height of the images, in pixels.
            variants: Makes the same infant at another age or in the scene of another seed, for `grow` and `reset`.
            task: Object that replaces the bundle's task; see `tasks.binding.CustomTask`.
            senses: Objects that are added to the bundle's senses, by name; see `senses.custom.CustomSense`.
            companions: Objects that act in its world as well, by name; see `companions.companion.Companion`.

        Raises:
            BundleError: If the folder is not an intact bundle.
            ModelError: If MuJoCo rejects its model.
            RenderingError: If vision or the render mode needs OpenGL or a display that is not available.
            UnknownNameError: If there is no such render mode.
            ValueError: If the images have no size that images can have.
            KindError: If the task, a sense or a companion is no such object, or has the name of an existing one.
        """
        check_rendering(render_mode, width, height)
        self.render_mode, self._picture_size, self._infant = render_mode, (width, height), open_variant(bundle)
        self.bundle = self._infant.bundle
        self.metadata = {"render_modes": available_modes(), "render_fps": round(1 / ms_to_s(self.manifest.step_ms))}
        self._draws = bool(render_mode or senses or companions) or task is not None or growing.sees_skin(self.manifest)
        self._variants, self._custom_task, self._custom_senses = variants, task, by_name(senses)
        self._custom_companions = by_name(companions, "companions", "name")
        self._noise, self.observer = NoiseStreams(self.np_random_seed), NO_OBSERVER
        self._bind()
        self._start(self.manifest.pose, chance=np.random.default_rng(0))  # Recordings keep what the first reset ends.
        self._renderer = self._open_renderer()
        self.action_space = action_space(self._act, self.manifest.actuation.voice is not None)
        self.observation_space = observation_space(self._senses, self._task)

    def _limited_spec(self) -> EnvSpec | None:
        """What Gymnasium says of it, if that has made it; `max_episode_steps` is what the task limits episodes to."""
        return with_limit(self._spec, self.max_steps)

    def _set_spec(self, spec: EnvSpec | None) -> None:
        self._spec = spec

    spec: Any = property(_limited_spec, _set_spec)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict]:
        """Start an episode in the bundle's default pose, or in another: `options={"pose": name}`.

        Other options: `age_months`, from now on; `scene_seed`, if it was made from a spec; `arousal`, where 0 is slack;
        and `objects`, which are elsewhere in this episode: `{"ball": {"x_cm": 20, "y_cm": 10}}` (docs/objects.md).

        Raises:
            UnknownNameError: If there is no such pose or option.
            TypeError: If the options are no dictionary.
            ValueError: If a seed, an age, an arousal or the place of an object is none that there can be.
            MimocError: If there is no such infant; nothing has changed then.
        """
        options = growing.checked_options(options, self._variants, self.manifest)
        seed = None if seed is None else checked_seed(seed)
        variant = growing.find_variant(self._variants, self.manifest, options)
        pose, elsewhere = growing.find_start(options, variant or self._infant, self._living, is_new=bool(variant))
        self.observer.resetting()
        super().reset(seed=seed)
        if seed is not None:
            self._noise.restart(seed)
        if variant:
            self._become(variant)
        self._living.arousal.level = options.get(growing.AROUSAL, self.manifest.actuation.arousal)
        observation = self._start(pose, elsewhere)
        if variant:
            self._renderer.start_again(self._infant.bare, self.data)
        self._renderer.show()
        info = {"is_success": False, "reward_terms": {}, "unstable": False, growing.AGE: self.age_months}
        self.observer.was_reset(seed, options, observation, info)
        return observation, info

    def grow(self, to: float) -> Observation:
        """Let the infant have another age from now on, in the midst of its episode; return the observation.

        It stays where it is and moves on as it moved: joint angles are kept as far as its joints reach now, and so are
        velocities, what lies around it, its task, signals on their way, its expression and all chance. Size, strength,
        joints, delays, acuity, skin and face are those of its new age. It is lifted out of what it would sink into.

        Args:
            to: The new age, in months, from 0 to 24; a younger one, too.

        Raises:
            ValueError: If this is not such an age.
            MimocError: If there is no such infant, or this environment cannot make it; nothing has changed then.
        """
        variant = growing.find_variant(self._variants, self.manifest, {growing.AGE: to})
        if variant:
            growing.check_same_body(self._infant.bare, variant.bare)
            former, remembered = self._living, copy.deepcopy(self.companions.state)
            self._become(variant)
            growing.carry_on(former, self._living)
            self.companions.state = remembered
            self._renderer.set_model(self._infant.bare, self.data)
            self._renderer.show()
            self.observer.grew(self.age_months)
        return self._observe()

    def step(self, action: npt.NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Apply an action for one control step; values outside the action space are clipped.

        Raises:
            ValueError: If the action has the wrong shape or is not finite.
        """
        self.observer.stepping()
        self._schedule.step(action, self.data)
        judged = self.judge(action, unstable=is_unstable(self.data))
        observation = self._observe()
        if judged[-1]["unstable"]:
            for reading in observation.values():
                np.nan_to_num(reading, copy=False)
        self.observer.stepped(action, observation, judged)
        self._renderer.show()
        return observation, *judged

    def get_state(self) -> dict[str, Any]:
        """Return the complete state: physics, delayed signals, noise, arousal, task and random generator.

        The state consists of arrays, lists and dictionaries that are independent of the environment and can be pickled.
        """
        counters = {"steps": self._steps, "random": self.np_random.bit_generator.state}
        infant = {growing.SEED: self.manifest.seed, growing.AGE: self.age_months}
        return copy.deepcopy({**self._living.state, **counters, **infant})

    def set_state(self, state: dict[str, Any]) -> Observation:
        """Restore a state of this environment, or of another one of the same bundle; return the observation.

        All later steps are exactly as they would have been from there. Derived quantities (contacts, positions of
        bodies) are those of the restored state, whereas after a step MuJoCo leaves those of one physics step before.

        The age of the state is restored, and in an environment made from a spec, so is its scene.

        Raises:
            ValueError: If it is no state of this infant, or one that cannot be restored here; nothing has changed then.
            MimocError: If there is no such infant.
        """
        variant = growing.variant_of_state(self._variants, self.manifest, state)
        with self._undone_on_failure() as before:
            if variant:
                self._become(variant)
                self._start(self.manifest.pose)
            with self._living.checked(state, self.get_state() if variant else before):
                self._restore(copy.deepcopy(state))
        if variant:
            self._renderer.start_again(self._infant.bare, self.data)
        self.observer.restored()
        return self._observe()

    def render(self) -> npt.NDArray[np.uint8] | None:
        """Return an image of the infant, shape (height, width, 3), in render mode `rgb_array`, otherwise None.

        Raises:
            RenderingError: If OpenGL is not available.
        """
        return self._renderer.render()

    def close(self) -> None:
        """Free the OpenGL contexts and close the window, if there are any; closing twice is fine.

        Its attributes, `layout` and `get_state` can still be read then, and a copy or a pickle gives an open one; all
        other methods raise Gymnasium's `ClosedEnvironmentError`.
        """
        for sense in self._senses.values():
            sense.close()
        self._renderer.close()

    def __getstate__(self) -> dict[str, Any]:
        """Support copying and pickling: leave out everything that is bound to this environment's model."""
        rebuilt = {"_infant": self._infant.again(self._living.model_as_built()), "state": self.get_state()}
        return {name: value for name, value in self.__dict__.items() if name not in BOUND} | rebuilt

    def __setstate__(self, kept: dict[str, Any]) -> None:
        """Bind the copy to its own model and restore the state of the original."""
        state = kept.pop("state")
        self.__dict__.update(kept)
        self._noise, self.observer = NoiseStreams(self.np_random_seed), NO_OBSERVER
        self._bind()
        self._restore(state)
        self._renderer = self._open_renderer()

    def _bind(self, former: Mapping[str, Sense] = MappingProxyType({})) -> None:
        """Look up in the model everything the manifest names, reusing resources of *former* senses, and reset."""
        model = self._infant.model if self._draws else self._infant.bare
        self.data = mujoco.MjData(model)
        self._act = bind_actuation(self.manifest.actuation, model)
        self._senses = bind_senses(self.bundle, model, former, self._custom_senses)
        self._task = bind_task(self.bundle, model, self._custom_task)
        timing = timing_of(self.manifest, self._senses)
        voice = Voice(self.manifest.actuation.voice) if self.manifest.actuation.voice else None
        companions = bind_companions(model, self.bundle, self._noise, self._custom_companions, self._senses, voice)
        self._schedule = Schedule(self._senses, self._act, model, timing, self._noise, companions, voice)
        self._living = SimulationState.bound(self.bundle, model, self.data, self._task, self._schedule, self._noise)

    def _open_renderer(self) -> EnvRenderer:
        manifest, model = self.manifest, self._infant.bare
        return EnvRenderer(self.render_mode, model, self.data, manifest, [manifest.root_body], self._picture_size)

    def _become(self, variant: Variant) -> None:
        """Bind to the infant at another age or in another scene, where nothing is started yet."""
        with self._undone_on_failure():
            self.bundle, self._infant = variant.bundle, variant
            self._bind(self._senses)
            check_same_space(self.observation_space, observation_space(self._senses, self._task))

    @contextmanager
    def _undone_on_failure(self) -> Iterator[dict[str, Any]]:
        """Yield the state; let the infant go on in it if anything fails, be it in a sense of the caller's own."""
        former, living, state = self._infant, self._living, self.get_state()
        try:
            yield state
        except Exception:
            if self._infant is not former:
                self.bundle, self._infant = former.bundle, former.again(living.model_as_built())
                self._bind(self._senses)
                self._renderer.set_model(self._infant.bare, self.data)
            self._restore(state)
            raise

    def _restore(self, state: dict[str, Any]) -> None:
        """Restore a state of the infant that is bound."""
        self._living.restore(state)
        self._steps, self.np_random.bit_generator.state = state["steps"], state["random"]

    @bounded()
    def _start(
        self,
        pose: str,
        elsewhere: Mapping[str, Any] = MappingProxyType({}),
        chance: np.random.Generator | None = None,
    ) -> Observation:
        """Put the infant into a pose, at rest, and objects elsewhere, start its task, and return the observation.

        The task draws from *chance*, by default from the random numbers of this environment.
        """
        self._steps = 0
        self._living.start(pose, chance or self.np_random, elsewhere)
        return self._observe()


def infant_of(function: str, env: Any, advice: str = "make one with mimoc.make") -> InfantEnv:
    """Return the infant of an environment, whatever wraps it.

    Raises:
        TypeError: If it has none, or several; it names the function that was called, and says what to do.
    """
    inside = getattr(env, "unwrapped", env)
    if not isinstance(inside, InfantEnv):
        raise TypeError(f"{function}: expected an environment of mimoc's, got {described(inside)}; {advice}")
    return inside


BOUND = {"data", "_act", "_senses", "_task", "_schedule", "_renderer", "_living", "_noise", "observer", "closed"}
"""Attributes that are not copied but bound anew."""

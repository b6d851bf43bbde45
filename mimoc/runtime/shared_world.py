"""A world with several infants, each with its own senses, delays, commands, task and age: one model, one physics."""

import copy
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Literal

import mujoco
import numpy as np
from gymnasium.spaces import Box

from mimoc.actuation.arousal import checked_arousal
from mimoc.base.errors import MimocError, UnknownNameError, check_name
from mimoc.base.random_streams import checked_seed
from mimoc.base.state_form import demand
from mimoc.base.units import ms_to_s
from mimoc.bundle.model import begin, bounded, is_unstable, out_of_memory, pose_of
from mimoc.bundle.physics_state import physics_of, set_physics
from mimoc.bundle.world import START, WorldBundle, load_world_model, overlaps
from mimoc.delays.merging import MergedSegment, merge_segments
from mimoc.delays.schedule import Segment
from mimoc.render.environment import EnvRenderer, available_modes, check_rendering
from mimoc.runtime.closing import closable
from mimoc.runtime.growing import AGE, AROUSAL, POSE, options_given
from mimoc.runtime.world_infant import WorldInfant
from mimoc.senses.custom import by_name
from mimoc.senses.sense import Observation

NOTHING: Mapping[str, Any] = MappingProxyType({})
Observations = dict[str, Observation]
"""What each infant observes, by name."""
Infos = dict[str, dict[str, Any]]
Stepped = tuple[Observations, dict[str, float], dict[str, bool], dict[str, bool], Infos]
PHYSICS, INFANTS, AGENTS = "physics", "infants", "agents"
"""What a state consists of."""
MAXVAL = 1e10
"""Position or velocity beyond which MuJoCo resets a simulation (its mjMAXVAL)."""
OPTIONS = POSE, AROUSAL
"""Of a reset, for an infant."""


@closable("observation_space", "action_space")
class SharedWorld:
    """Infants in one world, with the interface of PettingZoo's `ParallelEnv`: agents are infants, by their names.

    Observation, action, reward and info of each infant are those of an `InfantEnv`, and with a seed, infant i draws
    what that does with `seed + i`. An infant whose episode has ended is no agent any longer: it stays in the world, and
    commands nothing. If the simulation becomes unstable, all episodes end.
    """

    metadata: dict[str, Any] = {"name": "mimoc", "is_parallelizable": True}  # noqa: RUF012 - PettingZoo's own.
    closed = False

    def __init__(
        self,
        bundle: WorldBundle,
        render_mode: Literal["human", "rgb_array"] | None = None,
        width: int = 480,
        height: int = 480,
        tasks: Mapping[str, Any] = NOTHING,
        senses: Mapping[str, Mapping[str, Any]] = NOTHING,
        companions: Mapping[str, Mapping[str, Any]] = NOTHING,
        model: mujoco.MjModel | None = None,
    ):
        """Open a world.

        Args:
            bundle: The world.
            render_mode: `human` for a window that is updated at every step, `rgb_array` for images from `render()`.
            width: Width of the images, in pixels.
            height: Height of the images, in pixels.
            tasks: By infant, an object that replaces its task; see `tasks.task.CustomTask`.
            senses: By infant, objects that are added to its senses, by name; see `senses.custom.CustomSense`.
            companions: By infant, objects that act in the world as well, by name; see `mimoc.Companion`.
            model: Its model, if that has been loaded before.

        Raises:
            BundleError: If MuJoCo's files are not what mimoc writes.
            ModelError: If MuJoCo rejects its model.
            RenderingError: If vision or the render mode needs OpenGL or a display that is not available.
            UnknownNameError: If there is no such render mode, or no such infant.
            KindError: If a task, a sense or a companion is no such object.
        """
        check_rendering(render_mode, width, height)
        objects = {"tasks": tasks, "senses": senses, "companions": companions}
        self._objects = {what: by_name(given, what, "the name of an infant") for what, given in objects.items()}
        for name in (name for given in self._objects.values() for name in given):
            check_name("name of an infant of this world", name, bundle.infants)
        self.bundle, self.render_mode, self._picture_size = bundle, render_mode, (width, height)
        self.model = load_world_model(bundle) if model is None else model
        self.data = mujoco.MjData(self.model)
        self.infants: dict[str, WorldInfant] = {
            name: WorldInfant(infant, self.model, self.data, tasks.get(name), senses.get(name), companions.get(name))
            for name, infant in bundle.infants.items()
        }
        for infant in self.infants.values():
            infant.simulation = self
            infant.hear([other.voice for other in self.infants.values() if other.voice and other is not infant])
        self.possible_agents, self.agents = list(self.infants), list[str]()
        rate_hz = round(1 / ms_to_s(bundle.manifest.step_ms))
        self.metadata = {**type(self).metadata, "render_modes": available_modes(), "render_fps": rate_hz}
        self._roots = [infant.manifest.root_body for infant in self.infants.values()]
        self._segments: dict[str, tuple[Segment, ...]] = {}
        self._merged: list[MergedSegment[str]] = []
        self.options: dict[str, Any] = {}
        """Options of the world itself at its last reset."""
        self._start({})
        self._renderer = EnvRenderer(
            render_mode, self.model, self.data, bundle.manifest, self._roots, self._picture_size
        )

    def observation_space(self, agent: str) -> Any:
        """Return the space of what an infant observes.

        Raises:
            UnknownNameError: If there is no such infant.
        """
        check_name("name of an infant of this world", agent, self.infants)
        return self.infants[agent].observation_space

    def action_space(self, agent: str) -> Any:
        """Return the space of an infant's actions: one command for each of its commanded actuators.

        Raises:
            UnknownNameError: If there is no such infant.
        """
        check_name("name of an infant of this world", agent, self.infants)
        return self.infants[agent].action_space

    @property
    def state_space(self) -> Box:
        """The space of `state`."""
        size = self.model.nq + self.model.nv + self.model.na
        return Box(-MAXVAL, MAXVAL, (size,), np.float32)

    def state(self) -> np.ndarray:
        """Return the physics of the whole world for PettingZoo: positions, velocities and activations, shape (n,).

        They are MuJoCo's `qpos`, `qvel` and `act`, of all infants and of what else moves. `get_state` returns what an
        episode is continued from.
        """
        physics = np.concatenate([self.data.qpos, self.data.qvel, self.data.act])
        return np.clip(np.nan_to_num(physics), -MAXVAL, MAXVAL).astype(np.float32)

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None) -> tuple[Observations, Infos]:
        """Start an episode of all infants.

        Args:
            seed: Infant i draws as an environment of its own with `seed + i`; None goes on drawing.
            options: By infant, a dictionary with its `pose` and its `arousal`: `{"anna": {"pose": "sitting"}}`.

        Raises:
            UnknownNameError: If there is no such infant, pose or option.
            TypeError: If options are no dictionary.
            ValueError: If the seed is not a non-negative integer, or an arousal none from 0 to 2.
            MimocError: If infants are within each other in these poses; no episode is on then.
        """
        poses, levels = self._checked(options_given(options))
        if seed is not None:
            first = checked_seed(seed)
            for number, infant in enumerate(self.infants.values()):
                infant.seed(first + number)
        for name, infant in self.infants.items():
            infant.living.arousal.level = levels.get(name, infant.manifest.actuation.arousal)
        self.options = {name: given for name, given in options_given(options).items() if name not in self.infants}
        for infant in self.infants.values():
            infant.observer.resetting()
        self.agents = []
        self._start(poses)
        self.agents = list(self.possible_agents)
        self._renderer.show()
        infos: Infos = {
            name: {"is_success": False, "reward_terms": {}, "unstable": False, AGE: infant.age_months}
            for name, infant in self.infants.items()
        }
        observations, given = self._observe(), options_given(options)
        for number, (name, infant) in enumerate(self.infants.items()):
            own_seed = None if seed is None else seed + number
            infant.observer.was_reset(own_seed, given.get(name, {}), observations[name], infos[name])
        return observations, infos

    def step(self, actions: Mapping[str, Any]) -> Stepped:
        """Apply an action of each agent for one control step; values outside the action spaces are clipped.

        Returns:
            Observations, rewards, terminations, truncations and infos of those who were agents, by name.

        Raises:
            ValueError: If an agent has no action, or one that has the wrong shape or is not finite.
            UnknownNameError: If there is an action of no agent.
        """
        if not self.agents:
            return {}, {}, {}, {}, {}
        controls = self._controls(actions)
        for name in self.agents:
            self.infants[name].observer.stepping()
        self._make_step(controls)
        unstable, agents = is_unstable(self.data), self.agents
        judged = {name: self.infants[name].judge(np.asarray(actions[name]), unstable=unstable) for name in agents}
        observations = self._observe()
        if unstable:
            for observation in observations.values():
                for reading in observation.values():
                    np.nan_to_num(reading, copy=False)
        self.agents = [name for name in agents if not (judged[name][1] or judged[name][2])]
        for name in agents:
            self.infants[name].observer.stepped(np.asarray(actions[name]), observations[name], judged[name])
        self._renderer.show()
        parts: list[Any] = [{name: judged[name][part] for name in agents} for part in range(4)]
        rewards, terminated, truncated, infos = parts
        return observations, rewards, terminated, truncated, infos

    def render(self) -> Any:
        """Return an image of all infants, shape (height, width, 3), in render mode `rgb_array`, otherwise None.

        Raises:
            RenderingError: If OpenGL is not available.
        """
        return self._renderer.render()

    def get_state(self) -> dict[str, Any]:
        """Return the complete state: physics, and of each infant signals, noise, arousal, task and random numbers."""
        infants = {name: infant.state for name, infant in self.infants.items()}
        physics = physics_of(self.model, self.data)
        return copy.deepcopy({PHYSICS: physics, INFANTS: infants, AGENTS: self.agents})

    def set_state(self, state: Mapping[str, Any]) -> Observations:
        """Restore a state of this world, or of another one of the same bundle; return the agents' observations.

        All later steps are exactly as they would have been from there.

        Raises:
            ValueError: If it is no state of this world; nothing has changed then.
        """
        before = self.get_state()
        demand(isinstance(state, Mapping) and set(before) <= set(state), "", state)
        demand(isinstance(state[INFANTS], Mapping) and list(state[INFANTS]) == self.possible_agents, INFANTS, state)
        demand(set(state[AGENTS]) <= set(self.possible_agents), AGENTS, state[AGENTS])
        try:
            for name, infant in self.infants.items():
                given, valid = ({**part[INFANTS][name], PHYSICS: part[PHYSICS]} for part in (state, before))
                with infant.living.checked(given, valid):
                    infant.living.restore_model(copy.deepcopy(given))
            self._restore(copy.deepcopy(dict(state)))
        except Exception:
            self._restore(before)
            raise
        for infant in self.infants.values():
            infant.observer.restored()
        return self._observe()

    def close(self) -> None:
        """Free the OpenGL contexts and close the window, if there are any; closing twice is fine."""
        for infant in self.infants.values():
            infant.close()
        self._renderer.close()

    def __getstate__(self) -> dict[str, Any]:
        """Support copying and pickling: the model as it was before any episode, and the state."""
        size = dict(zip(("width", "height"), self._picture_size, strict=True))
        options = {"bundle": self.bundle, "render_mode": self.render_mode, "model": self._model_as_built()}
        return {"options": {**options, **size, **self._objects}, "state": self.get_state()}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        """Open the same world again, and restore the state."""
        SharedWorld.__init__(self, **kept["options"])
        self._restore(kept["state"])

    def _model_as_built(self) -> mujoco.MjModel:
        """Return a copy of the model in which no episode has changed anything."""
        livings = [infant.living for infant in self.infants.values()]
        levels = [living.arousal.level for living in livings]
        for living in livings:
            living.arousal.level = living.arousal.as_built
        built = copy.copy(self.model)
        for living, level in zip(livings, levels, strict=True):
            living.fields.write_as_built(built)
            living.arousal.level = level
        return built

    def _checked(self, options: Mapping[str, Any]) -> tuple[dict[str, str], dict[str, float]]:
        """Return the poses and arousals that options name, by infant."""
        poses, levels = {}, {}
        for name, given in options.items():
            if name not in self.infants and not isinstance(given, Mapping):
                continue  # PettingZoo's own tests pass an option that means nothing.
            check_name("name of an infant of this world", name, self.infants)
            manifest = self.infants[name].manifest
            for key in (of_infant := options_given(given)):
                if key not in OPTIONS:
                    raise UnknownNameError("reset option of an infant in a world", str(key), OPTIONS)
            if (pose := of_infant.get(POSE)) is not None:
                known = {manifest.of_infant(other): other for other in manifest.poses}
                poses[name] = known[pose] if pose in known else pose_of(manifest, pose)
            if AROUSAL in of_infant:
                levels[name] = checked_arousal(of_infant[AROUSAL])
        return poses, levels

    @bounded()
    def _start(self, poses: Mapping[str, str]) -> None:
        """Put infants into their poses, or into those of other keyframes, at rest, and start their tasks."""
        mujoco.mj_resetDataKeyframe(self.model, self.data, self.model.key(START).id)
        for name, keyframe in poses.items():
            self.infants[name].take_pose(keyframe)
        if poses and (depths := overlaps(self.model, self.data, self._roots)):
            first, second = (self.possible_agents[index] for index in next(iter(depths)))
            raise MimocError(f"'{first}' and '{second}' are within each other in these poses; reset to others")
        mujoco.mj_kinematics(self.model, self.data)
        for infant in self.infants.values():
            infant.living.constraints.keep(self.data)
        begin(self.model, self.data)
        for infant in self.infants.values():
            infant.start()
        for infant in self.infants.values():
            infant.living.start_signals()

    def _controls(self, actions: Mapping[str, Any]) -> dict[str, Any]:
        """Return the controls of all infants' actions; those who are no agents command nothing."""
        for name in actions:
            check_name("name of an infant whose episode goes on", name, self.agents)
        if missing := [name for name in self.agents if name not in actions]:
            raise ValueError(f"expected an action of each of {', '.join(self.agents)}; there is none of {missing[0]}")
        return {
            name: infant.schedule.controls(actions.get(name, infant.rest), self.data)
            for name, infant in self.infants.items()
        }

    def _make_step(self, controls: Mapping[str, Any]) -> None:
        """Go through one control step of all infants side by side."""
        infants, data = self.infants, self.data
        segments = {name: infant.schedule.begin(controls[name]) for name, infant in infants.items()}
        if segments != self._segments:  # Without jitter, they are the same objects in each control step.
            self._segments, self._merged = segments, merge_segments(segments)
        for part in self._merged:
            for name, segment in part.begun:
                infants[name].schedule.command(segment, data)
            try:
                mujoco.mj_step(self.model, data, part.physics_steps)
            except mujoco.FatalError as error:
                raise out_of_memory(error) from None
            for name, segment in part.ended:
                infants[name].schedule.sample(segment, data)

    def _observe(self) -> Observations:
        """Return what the agents observe."""
        return {name: self.infants[name].observe() for name in self.agents}

    def _restore(self, state: dict[str, Any]) -> None:
        """Restore a state, which is not kept."""
        for name, infant in self.infants.items():
            infant.living.restore_model(state[INFANTS][name])
        set_physics(self.model, self.data, state[PHYSICS])
        for name, infant in self.infants.items():
            infant.living.restore_signals(state[INFANTS][name])
            infant.restore_counters(state[INFANTS][name])
        self.agents = list(state[AGENTS])

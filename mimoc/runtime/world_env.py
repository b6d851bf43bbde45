"""A world with several infants, each with its own senses, delays, commands, task and age: one model, one physics."""

from collections.abc import Mapping
from typing import Any, Literal

import mujoco
import numpy as np
from gymnasium.spaces import Box

from mimoc.base.errors import check_name
from mimoc.base.random_streams import checked_seed
from mimoc.base.state_form import checked_list, require
from mimoc.base.units import ms_to_s
from mimoc.bundle.variants import WorldMaker, WorldVariant
from mimoc.bundle.world import WorldBundle, load_world_model, manifests_of
from mimoc.render.environment import available_modes, check_rendering
from mimoc.runtime import growing
from mimoc.runtime.closing import closable
from mimoc.runtime.growing import OBJECTS, SEED
from mimoc.runtime.infant import Custom, Infant
from mimoc.runtime.sense import NOTHING, Observation, by_name
from mimoc.runtime.simulation import AgeSchedule, Pictures, Simulation
from mimoc.schema.objects import checked_moves, names_of

Observations = dict[str, Observation]
Infos = dict[str, dict[str, Any]]
Stepped = tuple[Observations, dict[str, float], dict[str, bool], dict[str, bool], Infos]
AGENTS = "agents"  # Part of a state: whose episodes go on.
MAXVAL = 1e10  # Position or velocity beyond which MuJoCo resets a simulation (its mjMAXVAL).


@closable("observation_space", "action_space")
class WorldEnv:
    """Infants in one world, with the interface of PettingZoo's `ParallelEnv`: agents are infants, by their names.

    Observation, action, reward and info of each infant are those of an `InfantEnv`, and with a seed, infant i draws
    what that does with `seed + i`. An infant whose episode has ended is no agent any longer: it stays in the world, and
    commands nothing. If the simulation becomes unstable, all episodes end.
    """

    metadata: dict[str, Any] = {"name": "mimoc", "is_parallelizable": True}  # noqa: RUF012 - PettingZoo's own.
    closed = False

    def __init__(
        self,
        bundle: WorldBundle | WorldVariant,
        render_mode: Literal["human", "rgb_array"] | None = None,
        width: int = 480,
        height: int = 480,
        tasks: Mapping[str, Any] = NOTHING,
        senses: Mapping[str, Mapping[str, Any]] = NOTHING,
        companions: Mapping[str, Mapping[str, Any]] = NOTHING,
        variants: WorldMaker | None = None,
    ):
        """Open a world.

        Args:
            bundle: The world, or the world with its model.
            render_mode: `human` for a window that is updated at every step, `rgb_array` for images from `render()`.
            width: Width of the images, in pixels.
            height: Height of the images, in pixels.
            tasks: By infant, an object that replaces its task; see `mimoc.runtime.task`.
            senses: By infant, objects that are added to its senses, by name; see `mimoc.runtime.sense`.
            companions: By infant, objects that act in the world as well, by name; see `mimoc.Companion`.
            variants: Makes the same infants at other ages and in other scenes, for `grow` and `reset`.

        Raises:
            BundleError: If MuJoCo's files are not what mimoc writes.
            ModelError: If MuJoCo rejects its model.
            RenderingError: If vision or the render mode needs OpenGL or a display that is not available.
            UnknownNameError: If there is no such render mode, or no such infant.
            KindError: If a task, a sense or a companion is no such object.
        """
        check_rendering(render_mode, width, height)
        variant = WorldVariant(bundle, load_world_model(bundle)) if isinstance(bundle, WorldBundle) else bundle
        objects = {"tasks": tasks, "senses": senses, "companions": companions}
        given = {what: by_name(by_infant, what, "the name of an infant") for what, by_infant in objects.items()}
        names, nothing = variant.bundle.infants, dict[str, Any]()
        for name in (name for by_infant in given.values() for name in by_infant):
            check_name("name of an infant of this world", name, names)
        tasks, senses, companions = given["tasks"], given["senses"], given["companions"]
        self._custom = {
            name: Custom.checked(tasks.get(name), senses.get(name, nothing), companions.get(name, nothing))
            for name in names
        }
        draws = bool(render_mode) or any(custom.is_any for custom in self._custom.values())
        draws = draws or any(map(growing.sees_skin, manifests_of(variant.bundle).values()))
        infants = {name: Infant(custom) for name, custom in self._custom.items()}
        pictures = Pictures(render_mode, width, height)
        self.render_mode = render_mode
        self.simulation = Simulation(variant, infants, variants, pictures, draws=draws)
        self.possible_agents, self.agents = list(infants), list[str]()
        rate_hz = round(1 / ms_to_s(variant.bundle.manifest.step_ms))
        self.metadata = {**type(self).metadata, "render_modes": available_modes(), "render_fps": rate_hz}

    @property
    def bundle(self) -> WorldBundle:
        """The world, at the present ages of its infants and in its present scene."""
        bundle: Any = self.simulation.bundle
        return bundle

    @property
    def model(self) -> mujoco.MjModel:
        """MuJoCo's model, which may be changed."""
        return self.simulation.model

    @property
    def data(self) -> mujoco.MjData:
        """MuJoCo's state."""
        return self.simulation.data

    @property
    def infants(self) -> Mapping[str, Infant]:
        """The infants by name."""
        return self.simulation.infants

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
            options: By infant, a dictionary with its `pose`, `arousal`, `age_months` and `objects`, whose places are
                around it: `{"anna": {"pose": "sitting"}}`; and of the world, `scene_seed`, if it was made from specs,
                and `objects`, whose places are around the first infant.

        Raises:
            UnknownNameError: If there is no such infant, pose, object or option.
            TypeError: If options are no dictionary.
            ValueError: If the seed is not a non-negative integer, or an age, an arousal or a place is none.
            MimocError: If there is no such infant, and nothing has changed then; or if infants are within each other as
                they start, and no episode is on then.
        """
        of_infants, scene_seed = self._split(growing.options_given(options))
        first = None if seed is None else checked_seed(seed)
        seeds = {} if first is None else {name: first + number for number, name in enumerate(self.possible_agents)}
        try:
            started = self.simulation.reset(seeds, of_infants, scene_seed)
        finally:
            self.agents = self.agents if self.simulation.is_started else []
        self.agents = list(self.possible_agents)
        return {name: start[0] for name, start in started.items()}, {name: start[1] for name, start in started.items()}

    def grow(self, to: Mapping[str, float]) -> Observations:
        """Let infants have other ages from now on, in the midst of their episodes; see `InfantEnv.grow`.

        Args:
            to: The new ages in months, by name.

        Returns:
            What the agents observe.

        Raises:
            UnknownNameError: If there is no such infant.
            ValueError: If one is no age from 0 to 24 months.
            MimocError: If there is no such infant, or this environment cannot make it; nothing has changed then.
        """
        for name in to:
            check_name("name of an infant of this world", name, self.infants)
        self.simulation.grow(to)
        return self._observe()

    def grow_by(self, schedules: Mapping[str, AgeSchedule]) -> None:
        """Let infants grow by schedules from now on, as by `mimoc.GrowthWrapper`; a reset must follow.

        Args:
            schedules: By infant, a function from the number of control steps taken so far to the age in months, such as
                `mimoc.growth_schedule` returns.

        Raises:
            UnknownNameError: If there is no such infant.
        """
        for name in schedules:
            check_name("name of an infant of this world", name, self.infants)
        self.simulation.grow_by(schedules)

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
        for name in actions:
            check_name("name of an infant whose episode goes on", name, self.agents)
        if missing := [name for name in self.agents if name not in actions]:
            raise ValueError(f"expected an action of each of {', '.join(self.agents)}; there is none of {missing[0]}")
        stepped = self.simulation.step({name: np.asarray(actions[name]) for name in self.agents})
        self.agents = [name for name in self.agents if not (stepped[name][2] or stepped[name][3])]
        parts: list[Any] = [{name: result[part] for name, result in stepped.items()} for part in range(5)]
        observations, rewards, terminated, truncated, infos = parts
        return observations, rewards, terminated, truncated, infos

    def render(self) -> Any:
        """Return an image of all infants, shape (height, width, 3), in render mode `rgb_array`, otherwise None.

        Raises:
            RenderingError: If OpenGL is not available.
        """
        return self.simulation.render()

    def get_state(self) -> dict[str, Any]:
        """Return the complete state, and who is an agent; see `Simulation.get_state`."""
        return {**self.simulation.get_state(), AGENTS: list(self.agents)}

    def set_state(self, state: Mapping[str, Any]) -> Observations:
        """Restore a state of this world, or of another one of the same bundle; return the agents' observations.

        All later steps are exactly as they would have been from there.

        Raises:
            ValueError: If it is no state of this world; nothing has changed then.
        """
        require(isinstance(state, Mapping) and AGENTS in state, "", state)
        agents = checked_list(state[AGENTS], AGENTS)
        require(set(agents) <= set(self.possible_agents), AGENTS, agents)
        self.simulation.set_state(state)
        self.agents = list(agents)
        return self._observe()

    def close(self) -> None:
        """Free the OpenGL contexts and close the window, if there are any; closing twice is fine."""
        self.simulation.close()

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: value for name, value in self.__dict__.items() if name not in ("simulation", "closed")}
        spaces = {name: (infant.action_space, infant.observation_space) for name, infant in self.infants.items()}
        return {**kept, "spaces": spaces, "kept": self.simulation.kept()}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        simulation, spaces = kept.pop("kept"), kept.pop("spaces")
        self.__dict__.update(kept)
        infants = {name: Infant(custom) for name, custom in self._custom.items()}
        for name, infant in infants.items():
            infant.action_space, infant.observation_space = spaces[name]
        self.simulation = Simulation.again(simulation, infants)

    def _split(self, options: dict[str, Any]) -> tuple[dict[str, Any], int | None]:
        """Return the options of a reset by infant, and the seed of the scene.

        Objects of the world are moved around the infant whose part their place names, or else around the first.
        """
        names, variants = self.possible_agents, self.simulation.variants
        known = [OBJECTS] if self.bundle.manifest.objects else []
        known += [SEED] if variants and variants.has_other_scenes else []
        of_infants = {}
        for name, given in options.items():
            if name not in (*names, *known) and not isinstance(given, Mapping) and name not in (OBJECTS, SEED):
                continue  # PettingZoo's own tests pass an option that means nothing.
            check_name("name of an infant of this world", name, [*names, *known])
            if name in names:
                of_infants[name] = growing.checked_options(given, variants, self.infants[name])
        places = options.get(OBJECTS, {})
        checked_moves(places, names_of(self.bundle.manifest.objects))
        for thing, place in places.items():
            named = (name for name in names if isinstance(place, str) and f" {name}_" in place)
            of_infant = of_infants.setdefault(next(named, names[0]), {})
            of_infant[OBJECTS] = {thing: place, **of_infant.get(OBJECTS, {})}
        return of_infants, checked_seed(options[SEED], SEED) if SEED in options else None

    def _observe(self) -> Observations:
        return {name: self.infants[name].observe() for name in self.agents}

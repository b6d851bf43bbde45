"""The simulation: one MuJoCo model and its state, and the infants in it, one or several."""

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import MimocError
from mimoc.base.random_streams import checked_seed
from mimoc.base.state_form import check_finite, require
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import STATE, begin, bounded, is_unstable, physics_of, set_physics
from mimoc.bundle.variants import Variant
from mimoc.bundle.world import WorldBundle, overlaps
from mimoc.render.environment import EnvRenderer
from mimoc.runtime import growing
from mimoc.runtime.companion import hear_each_other
from mimoc.runtime.control_step import ControlStep
from mimoc.runtime.growing import AROUSAL, SEED
from mimoc.runtime.infant import AGE, PHYSICS, Binding, Infant
from mimoc.runtime.objects import NOWHERE, Pose
from mimoc.runtime.sense import NOTHING, FloatArray, Observation

INFANTS, BEFORE = "infants", "before"
Stepped = tuple[Observation, float, bool, bool, dict[str, Any]]
AgeSchedule = Callable[[int], float]  # From the control steps that were taken so far to an age in months.


@dataclass(frozen=True, slots=True)
class Pictures:
    """Render mode and size of the pictures of a simulation."""

    mode: str | None = None
    width_px: int = 480
    height_px: int = 480


class Simulation:
    """A MuJoCo model and its state, and the infants and companions in it, independent of Gymnasium.

    Its infants may be of any age and get others, by `grow`, by the options of a reset, or by a schedule of growth. One
    that is alone has the empty name.
    """

    data: mujoco.MjData
    is_started = False  # Whether episodes are on: not after a reset that failed while it put infants into their places.

    def __init__(
        self,
        variant: Variant,
        infants: Mapping[str, Infant],
        variants: Any = None,
        pictures: Pictures | None = None,
        *,
        draws: bool = False,
    ):
        """Bind infants, by name, to a model in which no episode has changed anything yet, and start them.

        *variants* make the same infants at other ages and in other scenes; *draws* is whether anything draws them, so
        that a model needs the skins of their ages.
        """
        self._variant, self._draws, self.variants = variant, draws, variants  # The last makes other ages and scenes.
        self.infants: Mapping[str, Infant] = MappingProxyType(dict(infants))
        self.schedules: Mapping[str, AgeSchedule] = NOTHING
        self.steps_done = 0  # Control steps taken so far, in all episodes, by which infants with schedules grow.
        self._pictures = pictures or Pictures()
        for name, infant in infants.items():
            infant.name = name
            infant.simulation = self
            infant.render_mode = self._pictures.mode
        self._bind()
        for infant in infants.values():
            infant.action_space, infant.observation_space = infant.spaces()
        # Recordings keep what the first reset ends, so that this must be the same each time.
        self._start(chance=np.random.default_rng(0))
        self.renderer = self._open_renderer()

    @property
    def model(self) -> mujoco.MjModel:
        """MuJoCo's model, which may be changed; that of growing infants gets their skins when it is asked for."""
        return self._variant.model

    @property
    def bare(self) -> mujoco.MjModel:
        """The same model, maybe with the skins of another age."""
        return self._variant.bare

    @property
    def bundle(self) -> Bundle | WorldBundle:
        """The infant, or the world, at its present ages and in its present scene."""
        return self._variant.bundle

    @property
    def seed(self) -> int:
        """The seed of the scene."""
        return self.bundle.manifest.seed

    def grow_by(self, schedules: Mapping[str, AgeSchedule]) -> None:
        """Let infants grow by schedules, which count the control steps of this simulation."""
        self.schedules = MappingProxyType(dict(schedules))

    def reset(
        self,
        seeds: Mapping[str, int | None] = NOTHING,
        options: Mapping[str, Mapping[str, Any]] = NOTHING,
        scene_seed: int | None = None,
    ) -> dict[str, tuple[Observation, dict[str, Any]]]:
        """Start an episode of all infants, and return the observation and info of each.

        Args:
            seeds: By infant; one without a seed goes on drawing.
            options: By infant, its `pose`, `arousal` and `age_months`, and `objects` that are elsewhere.
            scene_seed: The scene, from now on.

        Raises:
            MimocError: If there are no such infants, and nothing has changed then; or if infants would start within
                each other, and no episode is on then.
        """
        given = {name: self._options(name, options.get(name)) for name in self.infants}
        seeds = {name: checked_seed(seed) for name, seed in seeds.items() if seed is not None}
        ages = {name: of_infant[AGE] for name, of_infant in given.items() if AGE in of_infant}
        variant = self.find(ages, given.get("", NOTHING).get(SEED, scene_seed))
        poses, elsewhere = growing.find_start(given, variant or self._variant, self.infants, is_new=bool(variant))
        for infant in self.infants.values():
            infant.observer.resetting()
        for name, seed in seeds.items():
            self.infants[name].draw_from(seed)
        if variant:
            self._become(variant)
        for name, infant in self.infants.items():
            infant.binding.arousal.level = given[name].get(AROUSAL, infant.manifest.actuation.arousal)
        self._start(poses, elsewhere, check=bool(poses or variant))
        if variant:
            self.renderer.start_again(self.bare, self.data)
        self.renderer.show()
        started: dict[str, tuple[Observation, dict[str, Any]]] = {}
        for name, infant in self.infants.items():
            observation = infant.observe()
            info = {"is_success": False, "reward_terms": {}, "unstable": False, AGE: infant.age_months}
            infant.observer.was_reset(seeds.get(name), given[name], observation, info)
            started[name] = observation, info
        return started

    def step(self, actions: Mapping[str, Any]) -> dict[str, Stepped]:
        """Make one control step; infants without an action command nothing, and their episodes do not go on."""
        self.grow_as_scheduled()
        controls, data = self._controls(actions), self.data
        acting = [self.infants[name] for name in actions]
        for infant in acting:
            infant.observer.stepping()
        self._control_step(controls)
        self.steps_done += 1
        unstable = is_unstable(data)
        stepped: dict[str, Stepped] = {}
        for infant in acting:
            action = actions[infant.name]
            judged = infant.judge(action, unstable=unstable)
            observation = infant.observe()
            if unstable:
                for reading in observation.values():
                    np.nan_to_num(reading, copy=False)
            stepped[infant.name] = (observation, *judged)
        for infant in acting:
            observation, reward, terminated, truncated, info = stepped[infant.name]
            infant.observer.stepped(actions[infant.name], observation, (reward, terminated, truncated, info))
        self.renderer.show()
        return stepped

    def _controls(self, actions: Mapping[str, Any]) -> dict[str, FloatArray]:
        if len(actions) < len(self.infants):
            actions = {**{name: infant.rest for name, infant in self.infants.items()}, **actions}
        return {name: schedule.controls(actions[name], self.data) for name, schedule in self._schedules.items()}

    def grow_as_scheduled(self) -> None:
        """Let infants grow to the ages that their schedules give now."""
        if self.schedules and (due := self._due()):
            self.grow(due)

    def grow(self, ages_months: Mapping[str, float]) -> None:
        """Let infants have other ages from now on, in the midst of their episodes; see `InfantEnv.grow`."""
        variant = self.find(ages_months)
        if variant is None:
            return
        growing.check_same_body(self.bare, variant.bare)
        former = [infant.binding for infant in self.infants.values()]
        before = self.ages_months
        remembered = [copy.deepcopy(infant.companions.state) for infant in self.infants.values()]
        self._become(variant)
        growing.carry_on(former, [infant.binding for infant in self.infants.values()])
        for infant, state in zip(self.infants.values(), remembered, strict=True):
            infant.companions.state = state
        self.renderer.set_model(self.bare, self.data)
        self.renderer.show()
        for name, age_months in self.ages_months.items():
            if age_months != before[name]:
                self.infants[name].observer.grew(age_months)

    @property
    def ages_months(self) -> dict[str, float]:
        """The age of each infant."""
        return {name: infant.age_months for name, infant in self.infants.items()}

    def observe(self) -> dict[str, Observation]:
        """Return what each infant observes."""
        return {name: infant.observe() for name, infant in self.infants.items()}

    def get_state(self) -> dict[str, Any]:
        """Return the state: physics, scene, and of each infant signals, noise, arousal, task, age and random generator.

        It consists of arrays, lists and dictionaries that are independent of the simulation and can be pickled.
        """
        infants = {name: infant.state for name, infant in self.infants.items()}
        is_accompanied = any(infant.companions for infant in self.infants.values())
        before = {BEFORE: self._seen_by_companions} if is_accompanied else {}
        physics = physics_of(self.bare, self.data)
        return copy.deepcopy({PHYSICS: physics, **before, INFANTS: infants, SEED: self.seed})

    @property
    def _seen_by_companions(self) -> FloatArray:
        """The physics before the last step, whose bodies and contacts companions see, shape (n,); n is 0 for none."""
        acting = (infant.companions for infant in self.infants.values() if len(infant.companions))
        return next((companions.before for companions in acting), np.zeros(0))

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore a state of this simulation, or of another one of the same bundle, with its ages and its scene.

        All later steps are exactly as they would have been from there. Derived quantities (contacts, positions of
        bodies) are those of the restored state, whereas after a step MuJoCo leaves those of one physics step before. If
        it cannot be restored, nothing has changed.
        """
        ages = {name: infant[AGE] for name, infant in _infants_in(state, [*self.infants]).items()}
        variant = self.find_in_state(ages, state[SEED])
        with self._undone_on_failure() as before:
            if variant:
                self._become(variant)
                self._start()
            valid = self.get_state() if variant else before
            with ExitStack() as checked:
                for name, infant in self.infants.items():
                    ours, theirs = ({**whole[INFANTS][name], PHYSICS: whole[PHYSICS]} for whole in (state, valid))
                    checked.enter_context(infant.checked(ours, theirs))
                self._restore(copy.deepcopy(state))
        if variant:
            self.renderer.start_again(self.bare, self.data)
        for infant in self.infants.values():
            infant.observer.restored()

    def render(self) -> npt.NDArray[np.uint8] | None:
        """Return a picture of all infants, shape (height, width, 3), in render mode `rgb_array`, otherwise None."""
        return self.renderer.render()

    def close(self) -> None:
        """Free the OpenGL contexts and close the window, if there are any."""
        for infant in self.infants.values():
            infant.close_senses()
        self.renderer.close()

    # Copies and pickles.

    def kept(self) -> dict[str, Any]:
        """Return what a copy is made of besides its infants: the model as built, and the state."""
        return {
            "variant": self._variant.again(_model_as_built([infant.binding for infant in self.infants.values()])),
            "variants": self.variants,
            "draws": self._draws,
            "pictures": self._pictures,
            "growth": (dict(self.schedules), self.steps_done),
            "state": self.get_state(),
        }

    @classmethod
    def again(cls, kept: Mapping[str, Any], infants: Mapping[str, Infant]) -> "Simulation":
        """Return a copy with these unbound infants, in the state of the original."""
        simulation = cls.__new__(cls)
        simulation._variant, simulation.variants, simulation._draws = kept["variant"], kept["variants"], kept["draws"]
        simulation.infants = MappingProxyType(dict(infants))
        simulation._pictures = kept["pictures"]
        simulation.schedules, simulation.steps_done = kept["growth"]
        for name, infant in infants.items():
            infant.name = name
            infant.simulation = simulation
            infant.render_mode = kept["pictures"].mode
        simulation._bind()
        simulation._restore(kept["state"])
        simulation.renderer = simulation._open_renderer()
        return simulation

    # Models.

    def _bind(self) -> None:
        model = self.model if self._draws else self.bare
        bundle = self.bundle
        self.data = mujoco.MjData(model)
        bundles = {"": bundle} if isinstance(bundle, Bundle) else bundle.infants
        for number, (name, infant) in enumerate(self.infants.items()):
            infant.bind(bundles[name], model, self.data, None if number else bundle)
        if isinstance(bundle, WorldBundle):
            hear_each_other(self.infants)
        self._schedules = {name: infant.schedule for name, infant in self.infants.items()}
        self._control_step = ControlStep(self._schedules, dict.fromkeys(self.infants, self.data))

    def _open_renderer(self) -> EnvRenderer:
        shown = self._pictures
        roots = [infant.manifest.root_body for infant in self.infants.values()]
        size_px = shown.width_px, shown.height_px
        return EnvRenderer(shown.mode, self.bare, self.data, self.bundle.manifest, roots, size_px)

    def find(self, ages_months: Mapping[str, Any], scene_seed: int | None = None) -> Variant | None:
        """Return the infants with ages and a scene, or None if they have these already; see `growing.find_variant`."""
        now = self.ages_months
        wanted = {**self.ages_months, **ages_months}
        return growing.find_variant(self.variants, self.bundle.manifest, now, wanted, scene_seed)

    def find_in_state(self, ages_months: Mapping[str, Any], scene_seed: Any) -> Variant | None:
        """Return the infants of a state, or None if they are those of now; see `growing.variant_of_state`."""
        manifest = self.bundle.manifest
        return growing.variant_of_state(self.variants, manifest, self.ages_months, ages_months, scene_seed)

    def _become(self, variant: Variant) -> None:
        """Bind to the infants of another variant, before anything is started."""
        with self._undone_on_failure():
            self._variant = variant
            self._bind()
            for infant in self.infants.values():
                growing.check_same_space(infant.observation_space, infant.spaces()[1])

    @contextmanager
    def _undone_on_failure(self) -> Iterator[dict[str, Any]]:
        """Yield the state, and restore it if anything fails, be it in a sense of the caller's own."""
        former, state = self._variant, self.get_state()
        bindings = [infant.binding for infant in self.infants.values()]
        try:
            yield state
        except Exception:
            if self._variant is not former:
                self._variant = former.again(_model_as_built(bindings))
                self._bind()
                self.renderer.set_model(self.bare, self.data)
            self._restore(state)
            raise

    # Episodes.

    def _options(self, name: str, options: Any) -> dict[str, Any]:
        due = self._due().get(name) if self.schedules else None
        checked = growing.checked_options(options, self.variants, self.infants[name])
        return checked if due is None else {AGE: due, **checked}

    def _due(self) -> dict[str, float]:
        due = {name: schedule(self.steps_done) for name, schedule in self.schedules.items()}
        return {name: age_months for name, age_months in due.items() if age_months != self.infants[name].age_months}

    @bounded()
    def _start(
        self,
        poses: Mapping[str, str] = NOTHING,
        elsewhere: Mapping[str, Pose] = NOWHERE,
        chance: np.random.Generator | None = None,
        *,
        check: bool = False,
    ) -> None:
        """Put infants into the poses of keyframes, at rest, and objects elsewhere, and start their tasks.

        Tasks draw from *chance*, by default from the random numbers of each infant. With *check*, infants that are
        within each other are an error.
        """
        self.is_started = False
        model = self.bare
        data = self.data
        infants = list(self.infants.values())
        growing.put(poses, self._variant, data)
        infants[0].binding.objects.start(data, elsewhere)
        if check and len(infants) > 1:
            roots = [infant.manifest.root_body for infant in self.infants.values()]
            if depths := overlaps(self.bare, self.data, roots):
                first, second = ([*self.infants][index] for index in next(iter(depths)))
                raise MimocError(
                    f"'{first}' and '{second}' are within each other as they start; reset to other poses or ages"
                )
        mujoco.mj_kinematics(model, data)
        for infant in infants:
            infant.binding.constraints.keep(data)
        begin(model, data)
        for infant in infants:
            infant.start_task(chance)
        for infant in infants:
            infant.start_signals()
        self.is_started = True

    def _restore(self, state: Mapping[str, Any]) -> None:
        model, data = self.bare, self.data
        for name, infant in self.infants.items():
            infant.restore_model(state[INFANTS][name])
        set_physics(model, data, state[PHYSICS])
        for name, infant in self.infants.items():
            infant.restore_signals(state[INFANTS][name])
        accompanied = [infant for infant in self.infants.values() if infant.companions]
        if accompanied:
            before = state[BEFORE]
            size = mujoco.mj_stateSize(model, STATE)
            require(isinstance(before, np.ndarray) and before.shape in ((0,), (size,)), BEFORE, before)
            check_finite(before, BEFORE)
            if len(before):
                mujoco.mj_setState(model, data, before, STATE)
                mujoco.mj_step(model, data)
                mujoco.mj_setState(model, data, state[PHYSICS], STATE)
            for infant in accompanied:
                infant.companions.before = before


def _model_as_built(bindings: Sequence[Binding]) -> mujoco.MjModel:
    """Return a copy of the model without the changes of episodes."""
    levels = [bound.arousal.level for bound in bindings]
    for bound in bindings:
        bound.arousal.level = bound.arousal.as_built
    built = copy.copy(bindings[0].model)
    for bound, level in zip(bindings, levels, strict=True):
        bound.fields.write_as_built(built)
        bound.arousal.level = level
    return built


def _infants_in(state: Any, names: Sequence[str]) -> Mapping[str, Any]:
    """Return the states of the infants, or raise a ValueError if it is no state of these."""
    require(isinstance(state, Mapping) and {PHYSICS, INFANTS, SEED} <= state.keys(), "", state)
    infants = state[INFANTS]
    require(isinstance(infants, Mapping) and list(infants) == list(names), INFANTS, infants)
    for name, infant in infants.items():
        require(isinstance(infant, Mapping) and AGE in infant, f"{INFANTS}.{name}", infant)
    return infants

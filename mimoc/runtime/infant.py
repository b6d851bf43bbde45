"""One infant in a simulation: its senses, commands, delays, task, arousal and face, alone or with others."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
from gymnasium.spaces import Box, Dict
from gymnasium.utils.seeding import np_random

from mimoc.base.errors import MimocError, check_name
from mimoc.base.state_form import check_form
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import time_of
from mimoc.bundle.variants import Face
from mimoc.runtime.actuation import Actuation, bind_actuation
from mimoc.runtime.arousal import Arousal
from mimoc.runtime.closing import closable
from mimoc.runtime.companion import Companions, bind_companions
from mimoc.runtime.control_step import Schedule
from mimoc.runtime.delays import timing_of
from mimoc.runtime.model_fields import Constraints, ModelFields, expression_fields, face_of, set_expression
from mimoc.runtime.noise import NoiseStreams
from mimoc.runtime.objects import Objects
from mimoc.runtime.sense import NOTHING, Observation, Sense, SkinState, bind_senses, by_name
from mimoc.runtime.sound import VOICE_HIGH, VOICE_LOW, Voice
from mimoc.runtime.task import NO_REWARD, Task, bind_task, check_judgement, reward_of


class Observer:
    """Receives every call of an infant; this default does nothing."""

    keeps = False  # Whether it receives control steps, which takes time.

    def resetting(self) -> None:
        """Called before a reset."""

    def was_reset(
        self, seed: int | None, options: Mapping[str, Any], observation: Observation, info: Mapping[str, Any]
    ) -> None:
        """Called after a reset."""

    def stepping(self) -> None:
        """Called before a control step."""

    def stepped(
        self, action: npt.NDArray[Any], observation: Observation, judged: tuple[float, bool, bool, Mapping[str, Any]]
    ) -> None:
        """Called after a control step with what `step` returns; arrays may be changed afterwards."""

    def grew(self, to: float) -> None:
        """Called when the infant has another age, in months."""

    def restored(self) -> None:
        """Called when a state was restored."""

    def expressed(self, expression: str) -> None:
        """Called when the facial expression changes."""

    def aroused(self, level: float) -> None:
        """Called when the arousal changes within an episode."""


NO_OBSERVER = Observer()  # The observer of an infant that nobody observes.


PHYSICS, AGE, STEPS, RANDOM = "physics", "age_months", "steps", "random"
Judged = tuple[float, bool, bool, dict[str, Any]]  # Reward, terminated, truncated and info of a control step.


@dataclass(frozen=True)
class Custom:
    """Objects that a script passes for one infant."""

    task: Any = None  # Replaces the bundle's task; see `mimoc.runtime.task`.
    senses: Mapping[str, Any] = field(default_factory=dict)  # Added to the bundle's senses, by name.
    companions: Mapping[str, Any] = field(default_factory=dict)  # Act in its world as well, by name.

    @classmethod
    def checked(cls, task: Any, senses: Any, companions: Any) -> "Custom":
        """Return objects, or raise a KindError if senses or companions are not in a dictionary."""
        return cls(task, by_name(senses), by_name(companions, "companions", "name"))

    @property
    def is_any(self) -> bool:
        """Whether there are any, which may draw."""
        return self.task is not None or bool(self.senses or self.companions)


@dataclass(frozen=True, slots=True)
class Binding:
    """The parts of an infant in one model; growth or another scene makes a new binding."""

    manifest: Manifest
    model: mujoco.MjModel
    data: mujoco.MjData
    actuation: Actuation
    senses: Mapping[str, Sense]
    task: Task
    schedule: Schedule
    voice: Voice | None
    constraints: Constraints
    objects: Objects
    arousal: Arousal
    face: Face | None
    fields: ModelFields  # All that its episodes change in the model.


@closable("layout", "get_state")
class Infant:
    """An infant in a simulation, alone or with others."""

    closed = False
    name = ""  # Its name in a world; empty if it is alone.
    simulation: Any  # The `Simulation` that it is in.
    bundle: Bundle
    render_mode: Any = None
    observer: Observer = NO_OBSERVER
    noise: NoiseStreams  # Random numbers of noise, jitter and companions, by channel.
    random: np.random.Generator  # Random numbers of its task.
    steps = 0  # Control steps of this episode so far.
    action_space: Any  # The space of its actions: one command for each of its commanded actuators.
    observation_space: Any  # The space of what it observes; like that of its actions, it stays as it is when it grows.
    binding: Binding  # What it has in its present model.
    _judged: Task | None = None  # The task whose first judgement was as it must be.
    _custom = Custom()

    def __init__(self, custom: Custom):
        self._custom = custom
        self.random, seed = np_random()
        self.noise = NoiseStreams(seed)

    def draw_from(self, seed: int) -> None:
        """Seed all random numbers of the infant."""
        self.random, _ = np_random(seed)
        self.noise.restart(seed)

    def render(self) -> Any:
        """Return a picture of its simulation; see `Simulation.render`."""
        return self.simulation.render()

    def bind(self, bundle: Bundle, model: mujoco.MjModel, data: mujoco.MjData, world: Any = None) -> None:
        """Look up all names of the manifest in a model that no episode has changed yet.

        The first of several infants gets the bundle of their *world*, for companions of all of them.
        """
        manifest, custom, noise = bundle.manifest, self._custom, self.noise
        actuation = bind_actuation(manifest.actuation, model)
        senses = bind_senses(bundle, model, self._former_senses(), custom.senses)
        task = bind_task(bundle, model, custom.task)
        voice = Voice(manifest.actuation.voice) if manifest.actuation.voice else None
        companions = bind_companions(model, bundle, noise, custom.companions, senses, voice, world)
        schedule = Schedule(senses, actuation, model, timing_of(manifest, senses), noise, companions, voice)
        face = face_of(bundle)
        constraints = Constraints(manifest.constraints, model)
        objects = Objects(manifest, model)
        changed = *constraints.model_fields, *task.model_fields, *expression_fields(face, model), *objects.model_fields
        fields = ModelFields(model, (*changed, *companions.model_fields))
        arousal = Arousal(manifest.actuation, model)
        self.bundle = bundle
        self.binding = Binding(
            manifest, model, data, actuation, senses, task, schedule, voice, constraints, objects, arousal, face, fields
        )

    def _former_senses(self) -> Mapping[str, Sense]:
        return self.binding.senses if hasattr(self, "binding") else NOTHING

    # What can be read of it.

    @property
    def model(self) -> mujoco.MjModel:
        """MuJoCo's model, which may be changed; that of a growing infant gets its skin when it is asked for."""
        return self.simulation.model

    @property
    def data(self) -> mujoco.MjData:
        """MuJoCo's state."""
        return self.binding.data

    @property
    def manifest(self) -> Manifest:
        """Everything the compiler tells the runtime about this infant."""
        return self.bundle.manifest

    @property
    def actuation(self) -> Actuation:
        """The mapping from actions to controls: actuators in the order of the action, and their limits."""
        return self.binding.actuation

    @property
    def senses(self) -> Mapping[str, Sense]:
        """What it senses with, by name."""
        return self.binding.senses

    @property
    def voice(self) -> Voice | None:
        """Its voice, if it has one."""
        return self.binding.voice

    @property
    def companions(self) -> Companions:
        """Other actors in its world, by name."""
        return self.binding.schedule.companions

    @property
    def caregiver(self) -> Any:
        """The adult by the infant, a `mimoc.Caregiver`, the same for all infants of a world.

        Raises:
            MimocError: If there is none.
        """
        first, *_ = self.simulation.infants.values()
        companion = first.companions.get("caregiver")
        if companion is None or not companion.attends_to_all:
            raise MimocError("this infant has no caregiver; add 'caregiver: {}' to the scene of its spec")
        return companion

    @property
    def task(self) -> Task:
        """The task that starts its episodes and judges its steps."""
        return self.binding.task

    @property
    def schedule(self) -> Schedule:
        """Its control step, with all signals on their way."""
        return self.binding.schedule

    @property
    def max_steps(self) -> int | None:
        """Control steps after which an episode is truncated; None is never."""
        return self.binding.task.steps

    @property
    def age_months(self) -> float:
        """The infant's age."""
        return self.bundle.manifest.child.age_months

    def layout(self, sense: str) -> tuple[str, ...]:
        """Return the name and unit of each element of a sense's observation, in order.

        Raises:
            UnknownNameError: If this infant has no such sense.
        """
        check_name("sense of this infant", sense, self.senses)
        layout = self.senses[sense].layout
        of_infant = self.manifest.of_infant
        return tuple(map(of_infant, layout)) if self.manifest.prefix else layout

    @property
    def skin(self) -> SkinState:
        """The current positions, bodies and forces of all skin points, without delay.

        Raises:
            UnknownNameError: If this infant has no sense of touch.
        """
        check_name("sense of this infant", "touch", self.senses)
        touch: Any = self.senses["touch"]
        return touch.skin_state(self.data)

    @property
    def arousal(self) -> float:
        """How much of its muscle tone the infant has: 0 is slack, 1 quiet."""
        return self.binding.arousal.level

    def effort(self) -> float:
        """Return the effort of the actuators in the last physics step, for a task to subtract from its reward.

        This is the sum of u² T, divided by n times the sum of T, over n actuators with peak torques T, where u is the
        activation of a muscle, or the fraction of the peak torque in use, muscle tone included (docs/own_reward.md).
        """
        return self.actuation.cost(self.data)

    def keypoints(self) -> npt.NDArray[np.float64]:
        """Return the BODY_25 keypoints in the world frame, shape (25, 3), [m]; those of missing limbs are NaN."""
        names, site = self.manifest.keypoints, mujoco.mjtObj.mjOBJ_SITE
        sites = np.array([mujoco.mj_name2id(self.binding.model, site, name) for name in names], int)
        return np.where(sites[:, None] < 0, np.nan, self.data.site_xpos[sites])

    @property
    def rest(self) -> npt.NDArray[np.float32]:
        """The action that commands nothing, shape (n,)."""
        return np.clip(0.0, self.action_space.low, self.action_space.high).astype(np.float32)

    def spaces(self) -> tuple[Box, Dict]:
        """Return the spaces of actions and observations at the present age.

        An action has one command for each commanded actuator, followed by the commands of a voice.
        """
        actuation, low, high = self.actuation, (), ()
        if self.voice:
            low, high = VOICE_LOW, VOICE_HIGH
        actions = Box(
            np.concatenate([actuation.low, low]).astype(np.float32),
            np.concatenate([actuation.high, high]).astype(np.float32),
            dtype=np.float32,
        )
        observed = [*self.senses.values(), self.task]
        return actions, Dict({name: space for part in observed for name, space in part.spaces.items()})

    # What can be done to it.

    def play(
        self, pressure_pa: npt.ArrayLike, sample_rate_hz: float, place_m: Sequence[float], body: str = "world"
    ) -> None:
        """Let a sound begin now, as from a loudspeaker, for an infant that hears.

        A recording does not contain it; what is to be simulated again lets a `Companion` sound.

        Args:
            pressure_pa: Sound pressure at 1 m, shape (n,), [Pa].
            sample_rate_hz: Samples per second.
            place_m: Its place in the frame of the body, shape (3,).
            body: The body of the model that it moves with.

        Raises:
            UnknownNameError: If this infant does not hear, or there is no such body.
            ValueError: If this is no sound or no place.

        Example:
            >>> import mimoc
            >>> import numpy as np
            >>> spec = mimoc.load_spec("nine_months.yaml").with_(senses={"hearing": {"output": "levels"}})
            >>> env = mimoc.make(spec).unwrapped
            >>> _ = env.reset(seed=0)
            >>> env.play(0.1 * np.sin(2 * np.pi * 1000 * np.arange(4800) / 24_000), 24_000, (0.0, 1.0, 0.2))
            >>> for _ in range(5):
            ...     observation = env.step(0 * env.action_space.sample())[0]
            >>> bool((observation["hearing"] > 20).all())  # [dB] above its threshold, at both ears.
            True
        """
        check_name("sense of this infant", "hearing", self.senses)
        check_name("body", body, [self.model.body(index).name for index in range(self.model.nbody)])
        hearing: Any = self.senses["hearing"]
        hearing.play(pressure_pa, sample_rate_hz, place_m, self.model.body(body).id, self.data)

    def set_expression(self, expression: str) -> None:
        """Change the facial expression.

        Raises:
            UnknownNameError: If there is no such expression.
        """
        set_expression(expression, self.binding.face, self.binding.model)
        self.observer.expressed(expression)

    def set_arousal(self, level: float) -> None:
        """Change the arousal for the rest of the episode, from the next physics step on.

        Raises:
            ValueError: If it is none from 0 to 2.
        """
        self.binding.arousal.level = level
        self.observer.aroused(level)

    def get_state(self) -> dict[str, Any]:
        """Return the complete state of its simulation; see `Simulation.get_state`."""
        return self.simulation.get_state()

    # What its simulation does with it.

    def start_task(self, chance: np.random.Generator | None = None) -> None:
        """Start the task in a state that an episode begins with; *chance* replaces its random numbers."""
        self.steps = 0
        self.task.start(self.data, self.random if chance is None else chance)

    def start_signals(self) -> None:
        """Reset companions and signals in a state that an episode starts from."""
        self.companions.reset(self.data)
        self.schedule.reset(self.data)
        self.task.check_observation()

    def observe(self) -> Observation:
        """Return what the senses and the task give, as fresh arrays."""
        return {**self.binding.schedule.observe(), **self.binding.task.observe()}

    def judge(self, action: npt.NDArray[Any], *, unstable: bool) -> Judged:
        """Count a control step; return reward, terminated, truncated and info."""
        self.steps += 1
        bound = self.binding
        task, verdict, reward = bound.task, NO_REWARD, 0.0
        if not unstable:
            verdict = task.judge(bound.data, action, self.effort)
            if verdict is not NO_REWARD:
                if self._judged is not task:
                    check_judgement(verdict, task)
                    self._judged = task
                reward = reward_of(verdict, task)
        truncated = task.steps is not None and self.steps >= task.steps
        info = {"is_success": verdict.success, "reward_terms": dict(verdict.reward_terms), "unstable": unstable}
        info[AGE] = self.age_months
        return reward, verdict.terminated or unstable, truncated, info

    def close_senses(self) -> None:
        """Free what its senses hold."""
        for sense in self.senses.values():
            sense.close()
        self.closed = True

    # Its state, without the physics, which several infants have in common.

    @property
    def state(self) -> dict[str, Any]:
        """Its state without the physics; not copied."""
        bound = self.binding
        companions = {"companions": self.companions.state} if self.companions else {}
        return {
            "signals": bound.schedule.state,
            "model": bound.fields.state,
            "task": bound.task.state,
            "noise": self.noise.state,
            "arousal": bound.arousal.level,
            **companions,
            STEPS: self.steps,
            RANDOM: self.random.bit_generator.state,
            AGE: self.age_months,
        }

    @contextmanager
    def checked(self, state: Any, valid: Mapping[str, Any]) -> Iterator[None]:
        """Check a state, physics included, against a valid one, and turn errors of restoring it into a ValueError."""
        try:
            signals = {name: valid["signals"][name] for name in ("noise", "motor_noise")}
            noise = {"seed": valid["noise"]["seed"]}
            lasting = {name: valid[name] for name in valid if name not in ("task", "companions", "before")}
            check_form(state, lasting | {"signals": signals, "noise": noise})
            self.schedule.check(state["signals"], time_of(state[PHYSICS]))
            yield
        except (AttributeError, IndexError, KeyError, OverflowError, TypeError) as error:
            raise ValueError(f"this state cannot be restored ({error}); give one that get_state returned") from error

    def restore_model(self, state: Mapping[str, Any]) -> None:
        """Restore model and task from a state, before the physics."""
        bound = self.binding
        bound.fields.state, bound.task.state = state["model"], state["task"]
        bound.arousal.level = state["arousal"]

    def restore_signals(self, state: Mapping[str, Any]) -> None:
        """Restore signals, noise, companions and random numbers from a state, after the physics."""
        self.schedule.state, self.noise.state = state["signals"], state["noise"]
        if self.companions:
            self.companions.state = state["companions"]
        self.steps, self.random.bit_generator.state = state[STEPS], state[RANDOM]

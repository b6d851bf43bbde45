"""Tasks: what starts each episode, and what is judged of each control step.

The task of an environment is that of its bundle, or an object that a script passes instead, which needs no record.
"""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any, NamedTuple

import gymnasium
import mujoco
import numpy as np

from mimoc.base.classes import class_name
from mimoc.base.errors import KindError
from mimoc.base.kinds import check_custom_object, function_of
from mimoc.base.state_form import check_form
from mimoc.bundle.io import Bundle
from mimoc.runtime.contract import check_observation, told
from mimoc.runtime.model_fields import ModelField, rows_by_name
from mimoc.runtime.sense import NOTHING, FloatArray, IntArray, Observation
from mimoc.runtime.term import Term, stack_terms
from mimoc.runtime.worlds import Worlds, worlds_of_one
from mimoc.schema.kinds import TASKS

FORCES = "xfrc_applied"  # Field of the state: force and torque on each body; 0 after a reset.


class Change(NamedTuple):
    """New values of a field of the model, which the task's `model_fields` must declare, or forces on `forced`."""

    where: Any
    """For which of k infants the field changes, shape (k,)."""
    values: Callable[[], Any]
    """Returns the new values of the n declared rows, shape (k, n), or (k, n, ...) for whole rows."""
    column: int | None = None
    """The number of each row that changes; None for whole rows."""


class Judgement(NamedTuple):
    """A task's judgement of a control step: numbers of one infant, or arrays of k infants, shape (k,), from a term.

    Example:
        >>> import mimoc
        >>> judgement = mimoc.Judgement({"height": 0.3, "effort": -0.1}, success=False)
        >>> round(judgement.reward, 3)
        0.2
    """

    reward_terms: Mapping[str, Any]
    """Terms of the reward, by name; `info` has them as `reward_terms`."""
    success: Any = False
    """Whether the goal is reached; `info` has it as `is_success`."""
    terminated: Any = False
    """Whether the episode ends with this step."""
    memory: Mapping[str, Any] = NOTHING
    """What the task remembers from now on, shape (k, ...), without what stays as it is; only from a term."""
    changes: Mapping[str, Change] = NOTHING
    """What changes in the model, by name of the field; only from a term."""

    @property
    def reward(self) -> Any:
        """Sum of the terms."""
        return sum(self.reward_terms.values(), 0.0)

    def of_one(self) -> "Judgement":
        """Return a term's judgement of one infant in numbers."""
        terms = {name: values.item() for name, values in self.reward_terms.items()}
        return Judgement(terms, bool(self.success), bool(self.terminated))


Verdict = Judgement  # Its former name, for tasks of scripts.
NO_REWARD = Judgement({})
EXPECTED = "expected a finite number, or a mimoc.Judgement of such by name"


def reward_of(judgement: Judgement, task: "Task") -> float:
    """Return the reward of one infant as a number, or raise a KindError."""
    try:
        reward = float(judgement.reward)
        if math.isfinite(reward):
            return reward
    except (TypeError, ValueError, AttributeError):  # Text, arrays of several numbers, or no mapping at all.
        pass
    check_judgement(judgement, task)
    raise KindError(f"task {task.class_name}: the terms of its reward add up to {told(judgement.reward)}; {EXPECTED}")


def check_judgement(judgement: Judgement, task: "Task") -> None:
    """Raise a KindError unless a judgement of one infant has the right form."""
    if not isinstance(judgement, Judgement) or not isinstance(judgement.reward_terms, Mapping):
        raise KindError(f"task {task.class_name}: its judgement is {told(judgement)}; {EXPECTED}")
    for name, value in judgement.reward_terms.items():
        if not _is_number(value) or not math.isfinite(value):
            raise KindError(f"task {task.class_name}: the term '{name}' of its reward is {told(value)}; {EXPECTED}")
    for name in ("success", "terminated"):
        if not _is_number(value := getattr(judgement, name)) or value not in (0, 1):
            raise KindError(
                f"task {task.class_name}: '{name}' of its judgement is {told(value)}; expected True or False"
            )


def check_term_judgement(
    judgement: Any, term: object, infants: int, memory: Mapping[str, Any], changeable: Collection[str]
) -> None:
    """Raise a KindError unless a term's judgement has the right shapes; no value is read, so that no device waits."""
    what = f"the term {class_name(term)}"
    if not isinstance(judgement, Judgement) or not isinstance(judgement.reward_terms, Mapping):
        raise KindError(f"{what}: its judgement is {told(judgement)}; expected a mimoc.Judgement")
    rows = {f"the term '{name}' of its reward": value for name, value in judgement.reward_terms.items()}
    rows |= {f"'{name}' of its changes: where": change.where for name, change in judgement.changes.items()}
    for name in ("success", "terminated"):
        if not isinstance(value := getattr(judgement, name), bool):
            rows[f"'{name}' of its judgement"] = value
    for of, values in rows.items():
        if _shape(values) != (infants,):
            raise KindError(f"{what}: {of} is {told(values)}; expected an array of shape ({infants},), one an infant")
    for name, values in judgement.memory.items():
        if name not in memory:
            known = ", ".join(memory) or "nothing"
            raise KindError(f"{what}: '{name}' of its memory is not what its task remembers: {known}")
        if _shape(values) != _shape(memory[name]):
            expected = f"expected an array of shape {_shape(memory[name])}, as before"
            raise KindError(f"{what}: '{name}' of its memory is {told(values)}; {expected}")
    for name in judgement.changes:
        if name not in changeable:
            raise KindError(f"{what}: changes '{name}', which the model_fields of its task do not declare")


def _shape(value: Any) -> tuple[int, ...] | None:
    return tuple(value.shape) if hasattr(value, "shape") else None


def _is_number(value: Any) -> bool:
    """Return whether something is a real number, or an array of one without axes."""
    if isinstance(value, (Real, np.bool_)):
        return True
    try:
        return _shape(value) == () and math.isfinite(value)
    except (TypeError, ValueError):
        return False


class Task:
    """What starts each episode and judges each control step.

    A task judges by a term, which runs on one infant, on many and on a device alike. `bind` sets it:

        @dataclass(frozen=True)
        class HeadUpTerm(Term):
            head: int               # Whole numbers say where, real ones how much; see `Term`.
            goal_m: float

            def __call__(self, worlds, action, memory):
                height_m = worlds.xpos[:, self.head, 2]
                return Judgement({"height": height_m}, success=height_m > self.goal_m)

        class HeadUp(Task):
            def bind(self, model, bundle):
                self.term = HeadUpTerm(model.body(bundle.manifest.anatomy.head).id, 0.4)

        env = mimoc.make("configs/nine_months.yaml", task=HeadUp(steps=500))

    The term gets the worlds of k infants, their actions, shape (k, n), before these are clipped, and what the task
    remembers of each, shape (k, ...) by name. A task that cannot be such an expression overrides `judge` instead, and
    runs on the CPU only.

    In this order, `bind` is called once for each model (at the start, and again when the scene changes); `start` at
    each reset, when the infant is in its pose; `judge` after each control step; then `observe`. Look names up in
    `bind` and keep indices. Draw random numbers only from the generator that `start` gets, so that a seed determines
    an episode. An environment is saved by `get_state` and restored by `set_state`: keep in `memory` what the task
    remembers within an episode, and declare in `model_fields` what it changes in the model.

    Example:
        >>> import mimoc
        >>> class Still(mimoc.Task):
        ...     def judge(self, data, action, effort):
        ...         return mimoc.Judgement({"speed": -float(abs(data.qvel).max())})
        >>> env = mimoc.make("nine_months.yaml", task=Still(steps=500))
        >>> _ = env.reset(seed=0)
        >>> observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
        >>> reward == info["reward_terms"]["speed"] < 0
        True
    """

    term: Term | None = None
    """Judges: `term(worlds, action, memory) -> Judgement` of k infants; None if `judge` does otherwise."""
    _rows: Mapping[str, np.ndarray] = NOTHING
    """What is remembered, with a leading axis of one infant."""
    forced: IntArray = np.array([], np.intp)
    """The bodies on which `judge` sets forces and torques, by a change of `FORCES`, shape (n,)."""
    _bound: "tuple[Term, mujoco.MjData, Any, Worlds] | None" = None
    _is_observed = False
    """Whether what it observes was as its spaces say."""
    _checked_term: Any = None
    """The bound term whose first judgement was as it must be."""

    def __init__(self, steps: int | None = None, term: Term | None = None, memory: Mapping[str, Any] = NOTHING):
        """Make a task.

        Args:
            steps: Control steps after which an episode is truncated. None is never; or, for a task that is passed as
                an object, after those that the spec's task has, if any.
            term: See `term`.
            memory: What is remembered before the first episode.
        """
        self.steps, self.term = steps, term
        self.remember(**memory)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in self.__dict__.items() if name not in ("_bound", "_checked_term")}

    def bind(self, model: mujoco.MjModel, bundle: Any) -> None:
        """Look up names in a model; tasks that a bundle names are bound when they are made instead.

        Args:
            model: The infant and its world.
            bundle: The `mimoc.Bundle` it comes from; `bundle.manifest` names the parts of the infant.
        """

    @property
    def class_name(self) -> str:
        """Module and class of the task, or of the object that it stands for, joined by a colon."""
        return class_name(self)

    @property
    def memory(self) -> dict[str, np.ndarray]:
        """What the task remembers of an infant within an episode, by name: arrays whose shapes and types never change.

        What has the name of one of its `spaces` is observed.
        """
        return {name: values[0, ...] for name, values in self._rows.items()}  # Arrays, also of a single number.

    @property
    def spaces(self) -> Mapping[str, gymnasium.Space]:
        """Space of each array that it adds to the observation, by name."""
        return NOTHING

    @property
    def model_fields(self) -> Sequence[ModelField]:
        """What `start` and `judge` change in the model; all else in it must stay as it is."""
        return ()

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Start an episode.

        Args:
            data: A state that has just been reset, with all that follows from it (`mj_forward`). Whoever changes it
                calls `mj_forward` afterwards.
            generator: Source of all random numbers.
        """

    def observe(self) -> Observation:
        """Return its part of the observation, as fresh arrays within `spaces`."""
        return {name: np.array(self._rows[name][0], space.dtype) for name, space in self.spaces.items()}

    def check_observation(self) -> None:
        """Check the observation when the first episode starts."""
        if not self._is_observed:
            try:
                observed = self.observe()
            except KeyError as error:
                raise KindError(f"task {self.class_name}: it observes {error}, which it does not remember") from error
            check_observation(f"task {self.class_name}", observed, self.spaces)
            self._is_observed = True

    def judge(self, data: mujoco.MjData, action: np.ndarray, effort: Callable[[], float]) -> Judgement:
        """Return the reward of the control step that has just been taken, and whether it ends the episode.

        Args:
            data: The state after it.
            action: The action, shape (n,), before it is clipped.
            effort: Returns the cost of the actuators' work in the last physics step (`InfantEnv.effort`).

        Raises:
            KindError: If a subclass neither overrides this nor sets a term, or the term's first judgement has not the
                shapes that are expected.
        """
        if self.term is None:
            if type(self) is not Task:
                raise no_judge(self)
            return NO_REWARD
        term, worlds = self.term_of_one(data)
        judgement: Judgement = term(worlds, np.asarray(action)[None], self._rows)
        if self._checked_term is not term:
            check_term_judgement(judgement, term, 1, self._rows, {FORCES, *rows_by_name(self.model_fields)})
            self._checked_term = term
        if judgement.memory:
            self._rows = {**self._rows, **{name: np.array(values) for name, values in judgement.memory.items()}}
        for name, change in judgement.changes.items():
            if change.where[0]:
                is_force = name == FORCES
                array = getattr(data if is_force else data.model, name)
                rows = self.forced if is_force else rows_by_name(self.model_fields)[name]
                array[rows if change.column is None else (rows, change.column)] = change.values()[0]
        return judgement.of_one()

    @property
    def state(self) -> dict[str, Any]:
        """What it remembers within an episode; it can be set.

        Raises:
            ValueError: If what is set has another form.
        """
        return self.memory

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        check_form(state, self.memory, "task")
        self.remember(**{name: state[name] for name in self._rows})

    def remember(self, **values: Any) -> None:
        """Set what is remembered, by name; values keep their types."""
        types = {name: rows.dtype for name, rows in self._rows.items()}
        self._rows = {**self._rows, **{name: np.array([value], types.get(name)) for name, value in values.items()}}

    def term_of_one(self, data: mujoco.MjData) -> tuple[Any, Worlds]:
        """Return the term for one infant, and its world, for `start` to compute as `judge` does."""
        assert self.term is not None
        if self._bound is None or self._bound[0] is not self.term or self._bound[1] is not data:
            self._bound = self.term, data, stack_terms([self.term]), worlds_of_one(data)
        return self._bound[2:]


def no_judge(task: object) -> KindError:
    """Return the error of a task that cannot judge."""
    return KindError(
        f"task {class_name(task)} has neither a method 'judge' of its own nor a 'term'; override judge(data, action, "
        "effort), or set self.term in bind"
    )


@dataclass(frozen=True)
class SquaredCommands(Term):
    """Sum of squared commands, which are clipped to their ranges first, shape (k,); those of a voice do not count."""

    low: FloatArray  # Least command of each actuator, shape (n,).
    high: FloatArray  # Largest command of each actuator, shape (n,).

    def __call__(self, worlds: Worlds, action: Any) -> Any:
        """Return the sums for actions of shape (k, n)."""
        of_actuators = action[:, : self.low.shape[-1]]
        commands = worlds.xp.minimum(worlds.xp.maximum(of_actuators, self.low), self.high)
        return worlds.xp.sum(commands * commands, axis=-1)


def bind_task(bundle: Bundle, model: mujoco.MjModel, custom: Any = None) -> Task:
    """Return the task of a bundle, or the object that replaces it, bound to *model*."""
    if custom is not None:
        return CustomTask(custom, model, bundle)
    entry = bundle.manifest.task
    return function_of(TASKS[entry.kind].run, "bind")(entry, model, bundle)


class CustomTask(Task):
    """A task defined by a user's object, which is not part of a bundle.

    The object has `judge(data, action, effort)`, which returns a `Judgement` or the reward alone. It can also have
    `bind(model, bundle)`, called whenever a model was loaded; `start(data, generator)`, called at each reset;
    `observe()` and `spaces`, its part of the observation; `steps`, after which an episode is truncated, without which
    those of the bundle's task hold; `state`, a dictionary that can be read and set, with everything that it stores
    within an episode; and, if it is a `Task`, a `term` that judges.
    """

    def __init__(self, custom: Any, model: mujoco.MjModel, bundle: Bundle):
        check_custom_object("task", custom, "judge", "an object such as a mimoc.Task")
        if hasattr(custom, "bind"):
            custom.bind(model, bundle)
        steps: Any = getattr(custom, "steps", None)
        self._custom = custom
        if steps is not None and not (isinstance(steps, (int, np.integer)) and steps >= 1):
            what = f"task {self.class_name}: its 'steps' are {steps!r:.60}"
            raise KindError(f"{what}; expected a whole number from 1, or None")
        super().__init__(int(steps) if steps else bundle.manifest.task.steps, getattr(custom, "term", None))

    @property
    def class_name(self) -> str:
        """Module and class of the object, joined by a colon."""
        return class_name(self._custom)

    @property
    def model_fields(self) -> Sequence[ModelField]:
        """Fields of the model that it changes."""
        return getattr(self._custom, "model_fields", ())

    @property
    def spaces(self) -> Mapping[str, gymnasium.Space]:
        """Spaces of its part of the observation."""
        return getattr(self._custom, "spaces", {})

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Start an episode."""
        if hasattr(self._custom, "start"):
            self._custom.start(data, generator)

    def observe(self) -> Observation:
        """Return its part of the observation."""
        return self._custom.observe() if hasattr(self._custom, "observe") else {}

    def judge(self, data: mujoco.MjData, action: np.ndarray, effort: Callable[[], float]) -> Judgement:
        """Return its judgement of a control step."""
        judgement = self._custom.judge(data, action, effort)
        if judgement is NO_REWARD:
            raise no_judge(self._custom)
        return judgement if isinstance(judgement, Judgement) else Judgement({"reward": judgement})

    @property
    def state(self) -> dict[str, Any]:
        """Everything that it stores within an episode."""
        return getattr(self._custom, "state", {})

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        if hasattr(self._custom, "state"):
            self._custom.state = state

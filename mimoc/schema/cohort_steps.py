"""What a cohort does with each infant: the `do` of a cohort file."""

import re
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, StringConstraints, Tag, model_validator
from pydantic.config import JsonDict
from pydantic.fields import FieldInfo

from mimoc.base.errors import suggestion
from mimoc.base.quantities.milestones import MILESTONE_AGES
from mimoc.schema.base import KeyedError, Model
from mimoc.schema.names import Development
from mimoc.schema.quantities import Distinct, Whole, among
from mimoc.schema.wording import got

MAX_SEEDS = 10_000
FUNCTION = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*")  # A function of the user's own, as `module:function`.


def _without_separators(value: Any) -> Any:
    """Return a number that is written with separators, `200_000`, which YAML reads as text."""
    is_number = isinstance(value, str) and re.fullmatch("[0-9]{1,3}(_[0-9]{3})+", value)
    return int(value) if is_number else value


def _number(value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{got(value)} is not a number; write one, such as 0.99")
    return value


def _setting(value: Any) -> Any:
    if not isinstance(value, str | int | float):
        raise ValueError(f"{got(value)} is not a number, a text, true or false; write one of these")
    return value


def not_empty(items: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return a list, if there is something in it."""
    if not items:
        raise ValueError("this list is empty; name one or more, or remove the key")
    return items


Words = Annotated[str, StringConstraints(strict=True, min_length=1, max_length=4096)]
Steps = Annotated[
    Whole,
    Field(ge=1, le=10**9, json_schema_extra={"also": {"type": "string", "pattern": "^[0-9]+(_[0-9]+)+$"}}),
    BeforeValidator(_without_separators),
]


def _seeds(value: Any) -> Any:
    """Return seeds as a tuple: of one number, a list, or a range `0:3`."""
    if isinstance(value, str) and (ends := re.fullmatch(r"([0-9]{1,9}):([0-9]{1,9})", value)):
        value = range(int(ends[1]), int(ends[2]))
        if not value:
            raise ValueError(f"'{ends[0]}' contains no seed; write the smaller number first, such as 0:3")
    seeds = (value,) if type(value) is int else value
    if not isinstance(seeds, list | tuple | range) or not all(
        type(seed) is int and 0 <= seed < 2**31 for seed in seeds
    ):
        raise ValueError("these are not seeds; write a number, a list, or a range such as 0:3")
    if not seeds or len(set(seeds)) < len(seeds) or len(seeds) > MAX_SEEDS:
        raise ValueError(f"expected 1 to {MAX_SEEDS} different seeds; write a list, or a range such as 0:3")
    return tuple(seeds)


def _function(name: str) -> str:
    if not FUNCTION.fullmatch(name):
        raise ValueError(f"'{name}' does not name a function; write module:function, such as my_study:probe")
    return name


_ALSO: JsonDict = {"anyOf": [{"type": "integer", "minimum": 0}, {"type": "string", "pattern": "^[0-9]+:[0-9]+$"}]}
Seeds = Annotated[tuple[int, ...], BeforeValidator(_seeds), Field(json_schema_extra={"also": _ALSO})]
Function = Annotated[Words, AfterValidator(_function)]
Number = Annotated[int | float, BeforeValidator(_number)]
Setting = Annotated[str | bool | int | float, BeforeValidator(_setting)]


class BuildStep(Model):
    """Build the infant, and keep its bundle."""


class CheckStep(Model):
    """Check that the infant stays stable, as `mimoc check` does."""


def _trial(name: str) -> str:
    if name not in MILESTONE_AGES:
        raise ValueError(f"'{name}' is not a trial of milestones; {suggestion(name, MILESTONE_AGES)}")
    return name


class MilestonesStep(Model):
    """Find the ages from which on the child reaches motor milestones, near those at which it is expected to."""

    trials: Annotated[
        tuple[Annotated[Words, AfterValidator(_trial), among(lambda: [*MILESTONE_AGES])], ...],
        AfterValidator(not_empty),
        *Distinct,
    ] = ("sit", "hands_and_knees", "pull_to_stand", "stand")
    """Names of the trials; by default, those with WHO's mean and standard deviation."""
    delays: bool = False
    """Whether the child's own delays of senses and commands apply."""


class RunStep(Model):
    """Run the infant under a policy, as `mimoc run` does."""

    policy: Words = "random"
    """Name of a policy, the path of a trained one, relative to the cohort file, or a sum: `NAME+NAME`."""
    steps: Steps = 1000
    """Control steps."""
    seeds: Seeds = (0,)
    """Seeds of policy and episodes; each is a job."""
    record: bool = False
    """Record all that it does and senses, as `mimoc run --record` does, and measure its movement columns."""


class TrainStep(Model):
    """Train a policy, as `mimoc train` does."""

    algo: Literal["ppo", "sac"] = "ppo"
    """Learning algorithm."""
    steps: Steps = 500_000
    """Control steps, summed over all environments."""
    seeds: Seeds = (0,)
    """Seeds of the training; each is a job."""
    envs: Annotated[Whole, Field(ge=1, le=1024)] = 8
    """Number of parallel environments."""
    steps_per_episode: Steps | None = None
    """Control steps after which an episode is truncated; by default those of the task, or 500."""
    checkpoint_every: Steps | None = None
    """Control steps between checkpoints; by default 20,480, or one whole episode of each environment."""
    hyper: Mapping[str, Number] = Field(default_factory=dict)
    """Hyperparameters that differ from the defaults."""
    grow: Words | None = None
    """Ages in months between which the infant grows, such as `6:12`."""
    schedule: Literal["grown", "adult", "reversed", "shuffled"] = "grown"
    """Order of these ages."""
    grow_steps: Steps | None = None
    """Control steps that growth takes; by default, all."""


class ExperimentStep(Model):
    """Run one of mimoc's experiments, which brings its own infants."""

    name: Annotated[Words, Field(examples=["growth"])]
    """Name of the experiment."""
    quick: bool = False
    """Whether to run its smaller version."""
    development: Development | None = None
    """Law of development of its infants; by default that of `mimoc experiment`."""


class PythonStep(Model):
    """Call a function of the user's own."""

    function: Annotated[Function, Field(examples=["my_study:probe"])]
    """The function, as `module:function`."""
    seeds: Seeds = (0,)
    """Seeds it is called with; each is a job."""
    options: Mapping[str, Setting] = Field(default_factory=dict)
    """Further keyword arguments."""


def _shape(value: Any) -> str | None:
    shapes = {"a word": str, "a list": list | tuple, "a section": dict | Model}
    return next((shape for shape, types in shapes.items() if isinstance(value, types)), None)


def by_shape(wanted: str) -> tuple[Discriminator, FieldInfo]:
    """Return what marks alternatives whose shape, the `Tag` of each, tells them apart; messages say what is wanted."""
    return Discriminator(_shape), Field(json_schema_extra={"wanted": wanted})


Python = Annotated[
    Annotated[Function, Tag("a word")] | Annotated[PythonStep, Tag("a section")],
    *by_shape("a function; write module:function, or {function: module:function}"),
]
Experiment = Annotated[
    Annotated[Words, Tag("a word")] | Annotated[ExperimentStep, Tag("a section")],
    *by_shape("an experiment; write its name, or {name: growth, quick: true}"),
]


class StepChoice(Model):
    """One step, with its options below its name."""

    build: BuildStep | None = None
    """Build the infant, and keep its bundle."""
    check: CheckStep | None = None
    """Check that the infant stays stable."""
    milestones: MilestonesStep | None = None
    """Find the ages from which on the child reaches motor milestones."""
    run: RunStep | None = None
    """Run the infant under a policy."""
    train: TrainStep | None = None
    """Train a policy."""
    experiment: Experiment | None = None
    """Run one of mimoc's experiments."""
    python: Python | None = None
    """Call a function of the user's own."""

    @model_validator(mode="after")
    def _is_one(self) -> Self:
        if len(given := [name for name, value in self if value is not None]) != 1:
            message = f"{len(given)} steps in one item; begin each step with '- ' on a line of its own"
            raise KeyedError((), message)
        return self


WORDS = ("build", "check", "milestones", "run", "train")  # Steps that a word alone can ask for.


def _word(value: str) -> str:
    if value not in WORDS:
        names = tuple(StepChoice.model_fields)
        advice = f"write '{value}: ...', with what to do" if value in names else suggestion(value, names)
        raise ValueError(f"'{value}' alone is not a step; {advice}")
    return value


Step = Annotated[
    Annotated[Words, AfterValidator(_word), Field(json_schema_extra={"enum": [*WORDS]}), Tag("a word")]
    | Annotated[StepChoice, Tag("a section")],
    *by_shape("a step; write build, check, milestones, run, train, or {run: {steps: 1000}}"),
]
"""An item of `do`."""

StepSpec = BuildStep | CheckStep | MilestonesStep | RunStep | TrainStep | ExperimentStep | PythonStep


def step_of(item: str | StepChoice) -> tuple[str, StepSpec]:
    """Return the name of a step and its options, however briefly it was written."""
    if isinstance(item, str):
        return item, StepChoice.model_validate({item: {}}).__dict__[item]
    ((name, options),) = ((name, value) for name, value in item if value is not None)
    if isinstance(options, str):
        options = ExperimentStep(name=options) if name == "experiment" else PythonStep(function=options)
    return name, options

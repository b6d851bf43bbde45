"""A cohort file: which infants a study has, what is done with each and measured; and the files that keep results."""

import re
from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, StringConstraints, Tag, model_validator
from pydantic.config import JsonDict

from mimoc.base.errors import suggestion
from mimoc.base.quantities import MILESTONE_AGES, measures
from mimoc.base.rounding import rounded
from mimoc.schema.base import KeyedError, Model, plain
from mimoc.schema.body import IndividualSpec
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.schema.outline import language_of
from mimoc.schema.quantities import (
    Distinct,
    Identifier,
    Int64,
    NotNegative,
    PathText,
    Plain,
    Real,
    Whole,
    among,
    by_shape,
    version_one,
)
from mimoc.schema.reading import FileModel, got, unknown_key
from mimoc.schema.source import FileKind

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


COHORT = FileKind("cohort file", "mimoc, cohort, base and do", "cohort: spring")


def _known_key(key: str) -> str:
    """Return a dotted key of a spec, if there is one of this name."""
    language, path = language_of(InfantSpec), tuple(key.split("."))
    for depth in range(1, len(path) + 1):
        above = language.outline(path[: depth - 1])
        if not above.keys and not above.schema.get("additionalProperties"):
            raise ValueError(f"'{'.'.join(path[: depth - 1])}' has no keys below it; write that key alone")
        if not language.is_known(path[:depth]):
            raise ValueError(f"in a spec, {unknown_key(path[:depth], language)}")
    if key in ("mimoc", "name"):
        raise ValueError(f"'{key}' is the same for all infants; leave it out")
    return key


def _known_measure(name: str) -> str:
    if name not in measures() and not FUNCTION.fullmatch(name):
        raise ValueError(f"'{name}' is not a measure; {suggestion(name, measures())}; or name a module:function")
    return name


Seed = Annotated[Whole, Field(ge=0, le=2**32 - 1)]
Count = Annotated[Whole, Field(ge=1, le=1_000_000)]


class DrawnChildren(Model):
    """Children drawn from WHO's standards."""

    draw: Annotated[Count, Field(examples=[100])]
    """How many children."""
    sex: Literal["both", "female", "male"] = "both"
    """Their sex; of `both`, girls and boys take turns."""
    seed: Seed = 0
    """Seed of the draws; child i of a seed is the same however many are drawn."""
    sizes_only: Annotated[bool, Field(strict=True)] = False
    """Whether children differ only in size and sex, not in fat and rate of maturation."""


class RangeSpec(Model):
    """Equally spaced values."""

    start: Annotated[Real, Field(alias="from", ge=-1e9, le=1e9, examples=[0])]
    """The first value."""
    to: Annotated[Real, Field(ge=-1e9, le=1e9, examples=[24])]
    """The last value, if a whole number of steps leads to it."""
    step: Annotated[Real, Field(gt=0, le=1e9, examples=[3])]
    """Difference of two neighbours."""

    @model_validator(mode="after")
    def _rises(self) -> Self:
        if self.to < self.start:
            raise KeyedError(("to",), f"{self.to:g} is below 'from'; write the smaller value as 'from'")
        if (self.to - self.start) / self.step > 100_000:
            raise KeyedError(("step",), "this gives more than 100,000 values; give a larger step")
        if self.to > self.start and any(rounded(end + self.step) == rounded(end) for end in (self.start, self.to)):
            raise KeyedError(("step",), "neighbours are equal to the digits that files hold; give a larger step")
        return self


Pair = tuple[Annotated[Real, Field(ge=-1e9, le=1e9)], Annotated[Real, Field(ge=-1e9, le=1e9)]]


class DrawsSpec(Model):
    """Values drawn from a distribution."""

    uniform: Pair | None = None
    """Lowest and highest value of a uniform distribution."""
    log_uniform: Pair | None = None
    """The same for a value whose logarithm is uniformly distributed."""
    normal: Pair | None = None
    """Mean and standard deviation of a normal distribution."""
    step: Annotated[Real, Field(gt=0, le=1e9)] | None = None
    """Round the values to multiples of this."""
    n: Count | None = None
    """How many values; `design: sample` draws one for each infant instead."""
    seed: Seed = 0
    """Seed of the draws."""

    @model_validator(mode="after")
    def _is_one_distribution(self) -> Self:
        given = [name for name in ("uniform", "log_uniform", "normal") if getattr(self, name) is not None]
        if len(given) != 1:
            raise KeyedError((), "give one distribution: uniform, log_uniform or normal, such as 'uniform: [0, 24]'")
        low, high = getattr(self, given[0])
        if given[0] == "normal" and high <= 0:
            raise KeyedError(("normal",), f"a standard deviation of {high:g} is not positive; write [mean, deviation]")
        if given[0] != "normal" and low > high:
            raise KeyedError((given[0],), f"[{low:g}, {high:g}] is reversed; write the smaller number first")
        if given[0] == "log_uniform" and low <= 0:
            raise KeyedError((given[0],), f"{low:g} has no logarithm; give a number above 0")
        return self


def _canonical(value: Any) -> str:
    """Return the same text for equal plain data, however its numbers are written: 6, 6.0 and 6e0."""
    if isinstance(value, dict):
        return repr(sorted((key, _canonical(item)) for key, item in value.items()))
    if isinstance(value, list):
        return repr([_canonical(item) for item in value])
    if isinstance(value, float):
        value = rounded(value)
        return repr(int(value) if value.is_integer() else value)
    return repr(value)


def _kind_of_levels(value: Any) -> str | None:
    if isinstance(value, list | tuple):
        return "a list"
    keys = value.keys() if isinstance(value, dict) else ()
    if isinstance(value, DrawsSpec) or any(key in DrawsSpec.model_fields and key != "step" for key in keys):
        return "some draws"
    return "a range" if isinstance(value, dict | RangeSpec) else None


Levels = Annotated[
    Annotated[tuple[Any, ...], AfterValidator(not_empty), Tag("a list")]
    | Annotated[RangeSpec, Tag("a range")]
    | Annotated[DrawsSpec, Tag("some draws")],
    Discriminator(_kind_of_levels),
    Field(
        json_schema_extra={
            "wanted": "values to vary; write [a, b], {from: a, to: b, step: c} or {uniform: [a, b], n: 5}"
        }
    ),
]
"""The values of a key that is varied."""


class SampleSize(Model):
    """How many infants are sampled."""

    n: Annotated[Count, Field(examples=[500])]
    """How many infants."""
    seed: Seed = 0
    """Seed of the choice."""


class SampleDesign(Model):
    """Infants with values chosen at random."""

    sample: Annotated[SampleSize, Field(examples=[{"n": 500}])]
    """How many, and by which seed."""


class CohortSpec(FileModel):
    """A cohort: children, what is varied, what is done with each infant, and what is measured."""

    mimoc: Annotated[Literal[1], version_one("cohort files"), Field(examples=[1])]
    """Version of the language."""
    cohort: Annotated[Identifier, Field(examples=["spring"])]
    """Name of the cohort."""
    base: Annotated[
        Annotated[PathText, Tag("a word")] | Annotated[dict[str, Any], Tag("a section")],
        *by_shape("a spec; write the path of its file, or its keys"),
        Field(examples=["nine_months.yaml"]),
    ]
    """The infant that all others are made from: the path of a spec, or the spec itself."""
    children: (
        Annotated[
            Annotated[DrawnChildren, Tag("a section")]
            | Annotated[tuple[IndividualSpec, ...], AfterValidator(not_empty), Tag("a list")],
            *by_shape("children; write {draw: 100, seed: 7}, or a list of individuals"),
        ]
        | None
    ) = None
    """The children, each of which is the same at every age; by default, the child of the base."""
    vary: Mapping[Annotated[str, AfterValidator(_known_key)], Levels] = Field(default_factory=dict)
    """Values of keys of the spec, by dotted key."""
    design: Annotated[
        Annotated[Literal["grid", "zip"], Tag("a word")] | Annotated[SampleDesign, Tag("a section")],
        *by_shape("a design; write grid, zip or {sample: {n: 500, seed: 1}}"),
    ] = "grid"
    """How values are combined: each with each, in parallel, or at random."""
    do: Annotated[tuple[Step, ...], AfterValidator(not_empty), Field(examples=[["build"]])]
    """What is done with each infant."""
    measure: tuple[Annotated[str, AfterValidator(_known_measure)], ...] = ()
    """What the table shows; by default, every measure of every step."""

    @model_validator(mode="after")
    def _keys_do_not_overlap(self) -> Self:
        for key in self.vary:
            if self.children is not None and (key + ".").startswith("body.individual."):
                raise KeyedError(("vary", key), "'children' says this; leave one of the two out", against=("children",))
            for other in self.vary:
                if other.startswith(f"{key}."):
                    raise KeyedError(("vary", other), f"'{key}' is varied as a whole; leave one of the two out")
        return self

    @model_validator(mode="after")
    def _values_differ(self) -> Self:
        """Check that no two infants of a grid, or of values in parallel, are equal."""
        if isinstance(self.design, SampleDesign):
            return self
        lists: dict[tuple[str, ...], Sequence[Any]] = {
            ("vary", key): levels for key, levels in self.vary.items() if isinstance(levels, tuple)
        }
        if self.design == "zip":
            lists = {[*lists][-1]: [*zip(*lists.values(), strict=False)]} if 0 < len(lists) == len(self.vary) else {}
        if isinstance(self.children, tuple):
            lists[("children",)] = self.children
        for path, values in lists.items():
            seen = set[str]()
            for index, value in enumerate(values):
                if (text := _canonical(plain(value))) in seen:
                    what = "the row that ends with this" if self.design == "zip" and path[0] == "vary" else "this"
                    raise KeyedError((*path, index), f"{what} is there twice; leave one of the two out")
                seen.add(text)
        return self

    @model_validator(mode="after")
    def _design_fits(self) -> Self:
        sampled = isinstance(self.design, SampleDesign)
        for key, levels in self.vary.items():
            if isinstance(levels, DrawsSpec) and sampled == (levels.n is not None):
                advice = "remove n: 'design' says how many infants" if sampled else "add n, the number of values"
                raise KeyedError(("vary", key), f"design and draws do not fit; {advice}", against=("design",))
        return self


def _of_one_child(factors: Mapping[str, Any]) -> Mapping[str, Any]:
    """Return factors, if those that describe a child are numbers, and a text for its sex."""
    for name, value in factors.items():
        if name == "child" or name in IndividualSpec.model_fields:
            kinds = str if name == "sex" else int if name == "child" else (int, float)
            if not isinstance(value, kinds) or isinstance(value, bool):
                raise ValueError(f"'{name}' of a child is {type(value).__name__}")
    return factors


Key = Annotated[str, StringConstraints(pattern="^[0-9a-f]{32}$")]  # Hash of all that determines the result of a job.
Measure = None | bool | Int64 | Real | str
Factors = Annotated[Mapping[str, Plain], AfterValidator(_of_one_child)]


MAX_BYTES = 2**20  # Largest file of a result: 1 MB; results of mimoc's own steps have a kilobyte.


class MarkFile(Model):
    """`cohort.json`, which says that a folder is a cohort's."""

    cohort: str
    """Name of the cohort."""
    version: Literal[1]
    """Version of this kind of folder."""


class ResultFile(Model):
    """`results/<first two letters of the key>/<key>.json`: a job and what became of it."""

    job: Key
    cohort: str
    step: str
    seed: Int64 | None
    options: Mapping[str, Plain]
    factors: Factors
    status: Literal["ok", "failed"]
    measures: Mapping[str, Measure]
    versions: Mapping[str, str]
    error: str
    seconds: NotNegative

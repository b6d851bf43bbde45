"""A cohort file: which infants a study has, what is done and measured; and the files that keep its results."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Discriminator, Field, StringConstraints, Tag, model_validator

from mimoc.base.errors import suggestion
from mimoc.base.quantities import measures
from mimoc.base.rounding import rounded
from mimoc.schema.base import KeyedError, Model, plain
from mimoc.schema.body import IndividualSpec
from mimoc.schema.cohort_steps import FUNCTION, Step, by_shape, not_empty
from mimoc.schema.infant import InfantSpec
from mimoc.schema.outline import language_of
from mimoc.schema.quantities import Identifier, Int64, NotNegative, PathText, Plain, Real, Whole, version_one
from mimoc.schema.reading import FileModel
from mimoc.schema.source import FileKind
from mimoc.schema.wording import unknown_key

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


MOST_BYTES = 2**20  # Of the file of a result; 1 MB. Those of mimoc's own steps have one kilobyte.


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

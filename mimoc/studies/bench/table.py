"""Which tasks the benchmark has, at which ages, with which seeds: `tasks.yaml` as data."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from mimoc.base.errors import MimocError, check_name
from mimoc.schema import source
from mimoc.schema.base import Model, changed
from mimoc.schema.infant import InfantSpec, as_written, read_spec
from mimoc.schema.quantities import Real, Whole
from mimoc.schema.source import FileKind, dump

FILE = Path(__file__).with_name("tasks.yaml")
BABYBENCH_MONTHS = 18.0  # Age of MIMo's body, which BabyBench has.


class BenchTask(Model):
    """A task of the benchmark."""

    about: str
    """What the infant is to do."""
    ages_months: tuple[Real, ...]
    """Ages at which it is done."""
    episodes: Whole | None = None
    """Episodes at each age; None for as many as of other tasks."""
    likeness: bool = False
    """Whether the movement is compared with that of real infants."""
    spec: Mapping[str, Any]
    """What the spec of the infant says, besides its name and age and what is common to all."""


class Seeds(Model):
    """Seeds of the episodes, each range from the first to an end that is excluded."""

    practice: tuple[Whole, Whole]
    """For training and choosing."""
    test: tuple[Whole, Whole]
    """For the score; episode i has the seed `test[0] + i`."""


class BenchTable(Model):
    """The whole benchmark."""

    benchmark: str
    """Its name, with its version."""
    episodes: Whole
    """Episodes of a task at an age."""
    seeds: Seeds
    common: Mapping[str, Any]
    """What all specs of tasks say."""
    tasks: Mapping[str, BenchTask]
    babybench: Mapping[str, Mapping[str, Any]]
    """What the spec of each behaviour of BabyBench says."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A task at an age."""

    task: str
    age_months: float

    @property
    def name(self) -> str:
        """Its name in files: `reach/9`."""
        return f"{self.task}/{self.age_months:g}"

    @property
    def file_name(self) -> str:
        """The stem of its files: `reach_9`."""
        return f"{self.task}_{self.age_months:g}"

    @property
    def row(self) -> BenchTask:
        """Its task."""
        return bench_table().tasks[self.task]

    @property
    def spec(self) -> InfantSpec:
        """The spec of its infant."""
        data = changed(bench_table().common, self.row.spec)
        return _spec(self.task, self.age_months, data)

    @property
    def spec_text(self) -> str:
        """The spec as YAML."""
        return as_written(self.spec).text

    @property
    def episodes(self) -> int:
        """How many episodes a whole result has."""
        return self.row.episodes or bench_table().episodes


@cache
def bench_table() -> BenchTable:
    """Return the benchmark that ships with mimoc."""
    kind = FileKind("benchmark", "benchmark and tasks", "benchmark: mimoc-bench-1")
    return BenchTable.model_validate(source.read(FILE, kind).data)


def chosen_cells(tasks: Sequence[str] | None = None, ages_months: Sequence[float] | None = None) -> list[Cell]:
    """Return the cells of some tasks at some ages (None is all); raise a MimocError if there are none."""
    table = bench_table()
    for name in tasks or ():
        check_name("task of the benchmark", name, list(table.tasks))
    names = [name for name in table.tasks if tasks is None or name in tasks]
    known = sorted({age for name in names for age in table.tasks[name].ages_months})
    for age in ages_months or ():
        if age not in known:
            choices = ", ".join(f"{one:g}" for one in known)
            raise MimocError(f"{age:g} months is not an age of {', '.join(names)}; choose from {choices}")
    cells = [Cell(name, age) for name in names for age in table.tasks[name].ages_months]
    return [cell for cell in cells if ages_months is None or cell.age_months in ages_months]


def babybench_spec(behaviour: str) -> InfantSpec:
    """Return the spec of a behaviour of BabyBench; raise an UnknownNameError if there is none."""
    check_name("behaviour of BabyBench", behaviour, list(bench_table().babybench))
    return _spec(behaviour, BABYBENCH_MONTHS, dict(bench_table().babybench[behaviour]))


def _spec(name: str, age_months: float, data: dict[str, Any]) -> InfantSpec:
    head = {"mimoc": 1, "name": name, "age_months": age_months}
    return read_spec(source.parse(dump({**head, **data}), f"<{name}>"))

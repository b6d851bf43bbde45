"""Experiments as data: trials of cases by seed, tables, plots, and a page that compares them with published figures.

EXPERIMENT = Experiment(name="sitting", trial=sit, cases=grid(Infant, age_months=(4, 6)), seeds=range(10), ...)
run_experiment(EXPERIMENT, "out/sitting")
"""

import csv
import itertools
import os
import platform
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, is_dataclass, replace
from functools import cache, partial
from hashlib import sha256
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar, get_args

from mimoc.base.classes import takes
from mimoc.base.errors import MimocError, UnknownNameError, check_name
from mimoc.base.kinds import NAME, installed_entry_points
from mimoc.base.quantities import QUANTITIES, Quantity
from mimoc.bundle.files import write_file
from mimoc.bundle.io import Bundle
from mimoc.render.plots import Band, Line, Plot, Sheet, encode, require_matplotlib
from mimoc.schema.base import Model
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.schema.quantities import Real
from mimoc.studies.comparison import ASSUMPTION, Figure, Interval, Reference, band_of, interval
from mimoc.studies.experiments import EXPERIMENTS, GROUP
from mimoc.studies.jobs import JobStore, Progress, run_jobs
from mimoc.studies.notebook import (
    PAGES,
    Cell,
    Notebook,
    bodies_digest,
    markdown_table,
    open_notebook,
    page_text,
    table_rows,
)

Measured = Mapping[str, float | str | None]
"""What was measured, by the name of the quantity; None for what is never reached."""
Table = tuple[str, Iterable[Sequence[Cell]]]  # Names of columns, separated by commas, and rows.
Content = Table | list[Plot] | Iterator[Plot] | Sheet | bytes  # What a file shows; bytes are those of a PNG.
T = TypeVar("T")
TRIALS = "trials"  # Folder in which finished trials are kept until all of them are.
LIBRARIES = ("mimoc", "mujoco", "numpy")  # Libraries whose versions every report names.
LAWS: Mapping[Development, str] = {
    "published": "MIMo v2's body (`development: published`)",
    "maturing": "mimoc's own body (`development: maturing`)",
}
OTHER_BODY = (
    "This is not the paper's body. `mimoc experiment {name} --development published` runs the experiment on it, and "
    "shows the paper's figures beside ours."
)


class TrialResult(Model):
    """Measures and curves of a trial."""

    values: Mapping[str, Real]
    """Measures by name; what did not happen is left out."""
    traces: Mapping[str, tuple[Real, ...]] = {}
    """Curves by name."""


@dataclass(frozen=True, slots=True)
class Results:
    """The results of all trials of an experiment."""

    notebook: Notebook
    seeds: Sequence[int]
    by_case: Mapping[Any, Sequence[Any]]  # What the trial returned for each seed, by case.

    def values(self, case: Any, measure: str) -> list[float]:
        """Return a measure of a case for each seed that has it."""
        return [result.values[measure] for result in self.by_case[case] if measure in result.values]

    def mean(self, case: Any, measure: str) -> Interval:
        """Return the mean of a measure of a case over its seeds, of which at least one must have it."""
        return interval(self.values(case, measure))


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """What an experiment tries, and what it shows.

    The functions of `files`, `numbers` and `measured` take the `Results` of its trials, or what `measure` returned.

    Args:
        name: Its name: lower-case letters, digits and `_`.
        trial: Tries a case with a seed; returns measures by name, or a `TrialResult`. It is a function of a module, and
            is called in several processes unless the experiment is `quick`.
        cases: What is tried, frozen dataclasses of plain values or single ones; or a function that returns them.
        seeds: Seeds with which each case is tried.
        kept: Whether finished trials are kept in files, so that an interrupted experiment is resumed. Otherwise, trials
            return anything, and run one after another in this process.
        measure: Measures everything that is shown, in place of trials.
        quick: Fields of the smaller version that differ.
        files: Functions that return a table (CSV) or plots (PNG), by the name of the file. By default, a table of all
            measures.
        page: Text of the report in Markdown with `{numbers}`, or its file; `{table}` is a table of means, intervals and
            references, `{reproduction}` how to run the experiment again. By default, all tables and plots.
        numbers: Returns further numbers of the page by their names.
        references: What real infants do, by measure; several are about different ages.
        measured: Returns what stands beside the paper's figures if the infants have the paper's body.
        libraries: Further libraries on which the results depend.
        infants: Returns the infants whose bodies the page names by their digest, given the law of development.
        development: Law of development of its infants, which can be chosen; None if it has laws of its own.
    """

    name: str
    trial: Callable[[Any, int], Any] | None = None
    cases: Sequence[Any] | Callable[[Notebook], Iterable[Any]] = (None,)
    seeds: Sequence[int] = (0,)
    kept: bool = True
    measure: Callable[[Notebook], Any] | None = None
    quick: Mapping[str, Any] = field(default_factory=dict)
    files: Mapping[str, Callable[[Any], Content]] = field(default_factory=dict)
    page: str | Path = ""
    numbers: Callable[[Any], Mapping[str, object]] | None = None
    references: Mapping[str, Sequence[Reference]] = field(default_factory=dict)
    measured: Callable[[Any], Measured] | None = None
    libraries: Sequence[str] = ()
    infants: Callable[[Any], Iterable[Bundle | InfantSpec]] | None = None
    development: Development | None = None

    def __post_init__(self) -> None:
        if not NAME.fullmatch(self.name):
            raise MimocError(f"'{self.name}' cannot name an experiment; use lower-case letters, digits and '_'")
        if (self.trial is None) == (self.measure is None):
            raise MimocError(f"the experiment '{self.name}' needs either 'trial' or 'measure'")

    def run(self, notebook: Notebook, asked: str = "") -> Path:
        """Run it in the folder of a notebook, and return the path of the page; *asked* is what the command names."""
        small = replace(self, **self.quick) if notebook.quick else self
        results = small.measure(notebook) if small.measure else small._try_all(notebook)
        files = small.files
        if isinstance(results, Results) and small.kept and not any(file.endswith(".csv") for file in files):
            files = {f"{self.name}.csv": measures_table(), **files}
        for file, show in files.items():
            content = show(results)
            if isinstance(content, tuple):
                heading, rows = content
                notebook.write_table(file, heading, rows)
            else:
                sheet = content if isinstance(content, Sheet | bytes) else Sheet(tuple(content))
                write_file(notebook.folder / file, sheet if isinstance(sheet, bytes) else encode(sheet))
        page = notebook.write_page(small._page(notebook, results, files, asked or self.name))
        JobStore(notebook.folder, TRIALS, TrialResult).clear()
        return page

    def _try_all(self, notebook: Notebook) -> Results:
        assert self.trial
        cases = list(dict.fromkeys(self.cases(notebook) if callable(self.cases) else self.cases))
        jobs = [(case, seed) for case in cases for seed in self.seeds]
        count = notebook.counter(len(jobs))
        if self.kept:
            store = JobStore(notebook.folder, TRIALS, TrialResult)
            keys = [_key(self.trial, *job) for job in jobs]
            function = partial(_tried, self.name, self.trial)
            processes = 1 if notebook.quick else os.cpu_count() or 1
            done: Iterator[Any] = iter(
                store.complete(keys, lambda missing: run_jobs(function, [jobs[at] for at in missing], processes), count)
            )
        else:
            done = iter([count(self.trial(*job)) for job in jobs])
        return Results(notebook, self.seeds, {case: [next(done) for _ in self.seeds] for case in cases})

    def _page(self, notebook: Notebook, results: Any, files: Iterable[str], asked: str) -> str:
        numbers: dict[str, object] = {"seeds": len(self.seeds)}
        if isinstance(results, Results) and self.kept:
            numbers["table"] = summary_table(results, self.references)
        numbers |= self.numbers(results) if self.numbers else {}
        law = f" --development {notebook.development}" if notebook.development else ""
        command = f"mimoc experiment {asked} -o {notebook.folder.resolve().name}{law}{' --quick' * notebook.quick}"
        versions = ", ".join(f"{it} {version(it)}" for it in (*LIBRARIES, *self.libraries, "matplotlib"))
        machine = f"Python {platform.python_version()} on {platform.machine()}"
        bodies = f" Bodies: `{bodies_digest(self.infants(notebook.development))}`." if self.infants else ""
        numbers["reproduction"] = f"    {command}\n\nWith {versions} and {machine}.{bodies}"
        if notebook.development:
            numbers["law"] = LAWS[notebook.development]
            numbers["beside"] = OTHER_BODY.format(name=self.name)
        if notebook.development == "published" and self.measured:
            rows = figure_rows(self.name, self.measured(results))
            differs = page_text(f"{self.name}_published", **numbers)
            numbers["beside"] = page_text("figures", rows=table_rows(rows), differs=differs)
        text = self.page.read_text(encoding="utf-8") if isinstance(self.page, Path) else self.page
        if not text:
            shown = [f"![{file}]({file})" if file.endswith(".png") else f"In `{file}`." for file in files]
            text = "\n\n".join((f"# {self.name.replace('_', ' ').capitalize()}", *shown, "{table}"))
        if "{reproduction}" not in text:
            text += "\n\n## Reproduction\n\n{reproduction}"
        return text.strip("\n").format(**numbers)


def child(name: str, age_months: float, **keys: Any) -> InfantSpec:
    """Return the spec of a child whose further keys are as in a file."""
    return InfantSpec.model_validate({"mimoc": 1, "name": name, "age_months": age_months, **keys})


def grid(kind: Callable[..., T], **values: Iterable[Any]) -> list[T]:
    """Return cases with all combinations of some values of their fields, the last of which varies fastest."""
    return [kind(**dict(zip(values, chosen, strict=True))) for chosen in itertools.product(*values.values())]


# Tables and plots of all cases.


def measures_table(kind: type | None = None, **columns: str) -> Callable[[Results], Table]:
    """Return the function for a table with a row for each case, of a class, seed and measure.

    Columns are fields of cases by their headings; by default those in which cases differ.
    """

    def table(results: Results) -> Table:
        cases = [case for case in results.by_case if kind is None or isinstance(case, kind)]
        names = columns or {name: name for name in _differing(cases)}
        rows = (
            (*(_plain(case)[name] for name in names.values()), seed, *measure)
            for case in cases
            for seed, result in zip(results.seeds, results.by_case[case], strict=True)
            for measure in result.values.items()
        )
        return ",".join((*names, "seed", "measure", "value")), rows

    return table


def summary_table(results: Results, references: Mapping[str, Sequence[Reference]]) -> str:
    """Return a table in Markdown: number of seeds, mean and interval of each measure, beside real infants."""
    rows = list[tuple[str, ...]]()
    names = _differing(list(results.by_case))
    for case, same in results.by_case.items():
        for measure in dict.fromkeys(name for result in same for name in result.values):
            mean, values = results.mean(case, measure), results.values(case, measure)
            cells = (*(_text(_plain(case).get(name, "")) for name in names), measure, f"{len(values)}", mean.text())
            rows.append((*cells, *_beside(references.get(measure, ()), _plain(case).get("age_months"), mean.mean)))
    return markdown_table((*names, "measure", "n", "mean (95 %)", "real infants", "verdict", "source"), rows)


def _beside(references: Sequence[Reference], age_months: float | None, mean: float) -> tuple[str, str, str]:
    for reference in references:
        if age_months is None or reference.holds_at(age_months):
            low, high = ("" if end is None else f"{end:g}" for end in (reference.low, reference.high))
            shown = f"{low} to {high}" if low and high else f"at least {low}" if low else f"at most {high}"
            verdict = "inside" if reference.has(mean) else "outside"
            known = f"{reference.source} ({reference.certainty})"
            return shown, "no verdict" if reference.certainty == ASSUMPTION else verdict, known
    return "", "", ""


@dataclass(frozen=True, slots=True)
class Lines:
    """A plot of the mean of a measure, with its interval, over a field of cases: a line for each value of another."""

    x: str | Quantity
    y: str | Quantity
    by: str = ""
    reference: Reference | None = None

    def __call__(self, results: Results) -> list[Plot]:
        """Return the plot."""
        x, y = (it if isinstance(it, Quantity) else QUANTITIES.get(it, Quantity(it, it)) for it in (self.x, self.y))
        curves: dict[str, list[tuple[float, Interval]]] = {}
        for case in results.by_case:
            if results.values(case, y.name):
                label = _text(_plain(case)[self.by]) if self.by else ""
                curves.setdefault(label, []).append((_plain(case)[x.name], results.mean(case, y.name)))
        lines, bands = list[Line](), list[Band]()
        if self.reference and self.reference.low is not None and self.reference.high is not None:
            ends = [self.reference.youngest_months, self.reference.oldest_months]
            bands.append(Band(ends, [self.reference.low] * 2, [self.reference.high] * 2, "real infants", "usual"))
        for label, points in curves.items():
            at, means = zip(*sorted(points, key=lambda point: point[0]), strict=True)
            lines.append(Line(at, [mean.mean for mean in means], label))
            bands.append(band_of(at, means, label))
        return [Plot(x, y, tuple(lines), tuple(bands))]


def _plain(case: Any) -> dict[str, Any]:
    """Return a case as plain values by name."""
    if is_dataclass(case) and not isinstance(case, type):
        return {item.name: getattr(case, item.name) for item in fields(case)}
    return {} if case is None else {"case": case}


def _differing(cases: Sequence[Any]) -> list[str]:
    """Return the names of the fields in which some cases differ; those of different classes have other fields."""
    plain = [_plain(case) for case in cases]
    names = dict.fromkeys(name for values in plain for name in values)
    return [name for name in names if any(it.get(name) != plain[0].get(name) for it in plain)]


def _text(value: object) -> str:
    return f"{value:g}" if isinstance(value, float | int) and not isinstance(value, bool) else str(value)


# The paper's figures.


@cache
def figures_of(experiment: str) -> tuple[Figure, ...]:
    """Return the paper's figures that an experiment is compared with."""
    with (PAGES / "figures.csv").open(encoding="utf-8", newline="") as file:
        return tuple(Figure(**row) for row in csv.DictReader(file) if row.pop("experiment") == experiment)


def figure_rows(experiment: str, measured: Measured) -> Iterator[tuple[str, ...]]:
    """Yield a row for each of the paper's figures that was measured, of which small versions measure fewer."""
    for figure in figures_of(experiment):
        if figure.quantity in measured:
            yield figure.row(measured[figure.quantity])


# Running one.


@takes("an experiment, its name or its file", str, Path, Experiment)
def run_experiment(
    name: str | Path | Experiment,
    folder: str | Path,
    *,
    quick: bool = False,
    development: Development | None = None,
    progress: Progress | None = None,
) -> Path:
    """Run an experiment; return the path of its report, `NAME.md` in the folder.

    Existing files of the same names are replaced, each of them atomically.

    Args:
        name: An experiment, the name of one of mimoc's or of a plug-in, or a Python file that defines one.
        folder: Folder for tables, figures and report; it is created if necessary.
        quick: Whether to run a smaller version, which takes seconds or a few minutes.
        development: Law of development of the infants, of experiments that leave it open, which have a default. With
            `published`, the report has the paper's figures beside those measured.
        progress: Called with the number of steps done and their total.

    Raises:
        UnknownNameError: If there is no such experiment or law.
        MimocError: If the experiment has laws of its own, or a file defines none.
        OutputError: If the folder cannot be written.
        MissingExtraError: If matplotlib is not installed.
        RenderingError: If the experiment renders scenes and OpenGL is not available.

    Example:
        >>> import mimoc
        >>> mimoc.run_experiment("growth", "out/growth", quick=True).name
        'growth.md'
    """
    experiment = name if isinstance(name, Experiment) else find_experiment(name)
    law = law_of(experiment, development)
    require_matplotlib()
    notebook = open_notebook(experiment.name, folder, quick=quick, development=law, progress=progress)
    return experiment.run(notebook, experiment.name if isinstance(name, Experiment) else Path(name).name)


def find_experiment(name: str | Path) -> Experiment:
    """Return the experiment of a name, mimoc's or a plug-in's, or that which a Python file defines; or a MimocError."""
    if str(name).endswith(".py"):
        return _in_file(Path(name))
    added = {point.name: point for point in installed_entry_points().select(group=GROUP)}
    if name in EXPERIMENTS:
        module, _, value = EXPERIMENTS[str(name)].partition(":")
        return getattr(import_module(module), value)
    if name not in added:
        raise UnknownNameError("known experiment", str(name), [*EXPERIMENTS, *added])
    try:
        experiment = added[str(name)].load()
    except (Exception, SystemExit) as error:  # Whatever a plug-in's module does when it is imported.
        raise MimocError(f"the experiment '{name}' cannot be loaded: {error!r}") from error
    if not isinstance(experiment, Experiment) or experiment.name != name:
        raise MimocError(f"the entry point '{name}' of '{GROUP}' is no Experiment of this name")
    return experiment


def law_of(experiment: Experiment, development: str | None) -> Development | None:
    """Return the law of development of the infants of an experiment, None if it has its own; or raise a MimocError."""
    if development is None:
        return experiment.development
    check_name("law of development", development, get_args(Development))
    if experiment.development is None:
        raise MimocError(
            f"the experiment '{experiment.name}' has laws of development of its own; leave out 'development'"
        )
    return "published" if development == "published" else "maturing"


def _in_file(path: Path) -> Experiment:
    """Return the only experiment that a file defines; other processes find its functions by the name of the file."""
    if not path.is_file():
        raise MimocError(f"{path}: there is no such file")
    if (folder := str(path.resolve().parent)) not in sys.path:
        sys.path.insert(0, folder)
    try:
        module = import_module(path.stem)
    except (Exception, SystemExit) as error:  # Whatever the file does when it is imported.
        raise MimocError(f"{path}: cannot be imported ({error!r})") from error
    if Path(module.__file__ or "").resolve() != path.resolve():
        raise MimocError(f"{path}: there is another module '{path.stem}' ({module.__file__}); choose another name")
    found = {id(it): it for it in vars(module).values() if isinstance(it, Experiment)}
    if len(found) != 1:
        raise MimocError(f"{path}: defines {len(found) or 'no'} experiments; define one, EXPERIMENT = Experiment(...)")
    return next(iter(found.values()))


def _tried(name: str, trial: Callable[[Any, int], Any], case: Any, seed: int) -> TrialResult:
    result = trial(case, seed)
    try:
        return result if isinstance(result, TrialResult) else TrialResult(values=result)
    except ValueError:
        reason = f"a trial of the experiment '{name}' returned {result!r:.60}; return finite numbers by name"
        raise MimocError(reason) from None


def _key(trial: Callable[[Any, int], Any], case: Any, seed: int) -> Sequence[Any]:
    """Return what decides the result of a trial; of a function that is not mimoc's, the digest of its file as well."""
    plain = asdict(case) if is_dataclass(case) and not isinstance(case, type) else case
    key = (trial.__name__.strip("_"), trial.__module__, plain, seed)
    source = Path(getattr(sys.modules[trial.__module__], "__file__", None) or "")
    foreign = not trial.__module__.startswith("mimoc.") and source.is_file()
    return (*key, sha256(source.read_bytes()).hexdigest()) if foreign else key

"""The page of a cohort."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from mimoc.cohorts import Cohort, Job
from mimoc.cohorts.cohort import Progress, Status, status_of
from mimoc.cohorts.store import Store, finished_jobs
from mimoc.cohorts.table import Rows, rows_of
from mimoc.quantities import quantity_of
from mimoc.render.plots.drawing import draw_svg
from mimoc.reporting import words
from mimoc.reporting.cohort.children import children
from mimoc.reporting.cohort.measures import OF_CHILDREN, measures_of
from mimoc.reporting.page import Block, Cell, Drawings, Page, Section, TextBlock, number, table
from mimoc.version import __version__

MOST_FACTORS = 6
"""Factors that each measure is drawn by."""
MOST_PLOTS = 80
MOST_ERRORS = 20
"""Different errors that are listed."""
STATES = ("ok", "failed", "missing")
VERSION = "version."
UNKNOWN = (
    "Jobs that have not been done cannot be told from the folder alone. Name the cohort's file as well, with --cohort, "
    "and they are counted as missing."
)
CAPTION = (
    "Dots are medians, thick lines reach from the first to the third quartile, thin ones over the whole range; of what "
    "is true or false, dots are shares. With many different values of a number, each job is a dot."
)


def cohort_page(folder: Path, cohort: Cohort | None, progress: Progress) -> Page:
    """Return the page of a cohort.

    Args:
        folder: The folder of the cohort.
        cohort: The cohort itself; without it, jobs that are not done yet are not known.
        progress: Called with the number of results read and their total.

    Raises:
        MimocError: If the folder is not that of a cohort.
    """
    store = Store(folder)
    if cohort:
        store.check()
        jobs, damaged, shown = cohort.jobs(), (), cohort.spec.measure
    else:
        (jobs, damaged), shown = finished_jobs(store), ()
    status, rows = status_of(jobs, store), rows_of(jobs, store, shown, progress)
    sections = [_jobs(status, damaged, is_whole=cohort is not None), children(jobs, store)]
    sections += [_results(jobs, rows), _versions(rows)]
    infants = len({str(sorted(job.factors.items(), key=str)) for job in jobs})
    summary = f"{words.count(infants, 'infant')}, {words.count(status.jobs, 'job')}: "
    states = {"ok": "done", "failed": "failed", "missing": "not done yet"}
    numbers = {name: status.number(state) for state, name in states.items()}
    summary += words.listed([f"{count:,} {name}" for name, count in numbers.items() if count])
    return Page(
        kind="A cohort of mimoc",
        title=words.sentence(words.name(jobs[0].cohort if jobs else folder.name)),
        lead=(f"{summary}.",),
        sections=tuple(section for section in sections if section),
        made_by=f"Made by mimoc {__version__}.",
    )


def _jobs(status: Status, damaged: Sequence[str], *, is_whole: bool) -> Section:
    states = STATES if is_whole else STATES[:2]
    rows = [
        (Cell(step), *(number(f"{counts.get(state, 0):,}") for state in states))
        for step, counts in status.counts.items()
    ]
    rows.append((Cell("All"), *(number(f"{status.number(state):,}") for state in states)))
    blocks: list[Block] = [table(("step", *states), rows)]
    if not is_whole:
        blocks.append(TextBlock(UNKNOWN, "note"))
    if damaged:
        names = ", ".join(damaged[:3])
        blocks.append(TextBlock(f"{words.count(len(damaged), 'result')} cannot be read, such as {names}.", "warning"))
    return Section("jobs", "What was done", (*blocks, *_failures(status)))


def _failures(status: Status) -> Iterator[Block]:
    """Yield a table of the errors, the most frequent first, each with an infant and a log to look at."""
    errors: dict[tuple[str, str], list[int]] = {}
    for number_, failure in enumerate(status.failures):
        errors.setdefault((failure.job.step, failure.error), []).append(number_)
    if not errors:
        return
    rows = []
    for (step, error), numbers in sorted(errors.items(), key=lambda item: (-len(item[1]), item[0]))[:MOST_ERRORS]:
        first = status.failures[numbers[0]]
        who = ", ".join(f"{name} {value}" for name, value in first.job.factors.items())
        log = "/".join(first.log.parts[-3:])
        rows.append((Cell(step), number(f"{len(numbers):,}"), Cell(error, "bad"), Cell(who), Cell(log, "code")))
    yield TextBlock(f"{words.count(len(status.failures), 'job')} failed:")
    yield table(("step", "jobs", "error", "the first of these infants", "its log"), rows)
    if len(errors) > MOST_ERRORS:
        yield TextBlock(
            f"{len(errors) - MOST_ERRORS} more errors are in the table that 'mimoc cohort table' writes.", "note"
        )


def _results(jobs: Sequence[Job], rows: Rows) -> Section:
    """Return the section with the plots of each measure by each factor."""
    done = [row for row in rows if row["status"] == "ok"]
    names = [*rows[0]] if rows else []
    factors = _by_interest([name for name in names[1:] if _is_factor(name, names)], jobs)
    drawn, constant, left_out = [], [], dict[str, None]()
    for measure in measures_of(done, _measure_names(names)):
        if measure.is_constant:
            constant.append(measure)
            continue
        varied = measure.factors(factors)
        left_out |= dict.fromkeys(varied[MOST_FACTORS:])
        for factor in varied[:MOST_FACTORS]:
            drawn += [draw_svg(made)] if (made := measure.plot(factor)) else []
    blocks: list[Block] = []
    if drawn:
        blocks.append(Drawings(tuple(drawn[:MOST_PLOTS]), CAPTION))
    else:
        blocks.append(
            TextBlock("No measure differs between the jobs, or nothing varies that it could be drawn by.", "note")
        )
    if len(drawn) > MOST_PLOTS:
        blocks.append(TextBlock(f"{len(drawn) - MOST_PLOTS} more plots are left out.", "note"))
    if left_out:
        names = words.listed([quantity_of(name).heading for name in left_out])
        blocks.append(
            TextBlock(f"Each measure is drawn by at most {MOST_FACTORS} factors; these are left out: {names}.", "note")
        )
    if constant:
        same = [f"{measure.title}: {words.figure(measure.values[0])}" for measure in constant]
        blocks.append(TextBlock(f"The same for all jobs that have it: {'; '.join(same)}.", "note"))
    return Section("results", "Results", tuple(blocks))


def _is_factor(name: str, names: Sequence[str]) -> bool:
    """Return whether a column tells infants or jobs apart: it stands before `seed`, and is not the step."""
    return names.index(name) < names.index("seed") and name != "step"


def _measure_names(names: Sequence[str]) -> list[str]:
    """Return the columns that hold measures: those after `status`, up to the versions."""
    after = names[names.index("status") + 1 :] if "status" in names else []
    return [name for name in after if not name.startswith(VERSION) and name not in ("error", "log")]


def _by_interest(names: Sequence[str], jobs: Sequence[Job]) -> list[str]:
    """Return factors in the order in which they are drawn: what is varied, then sex, then what children measure."""
    of_child = [name for name in names if name == "sex" or name.endswith(OF_CHILDREN)]
    return [*(name for name in names if name not in of_child), *sorted(of_child, key=lambda name: name != "sex")]


def _versions(rows: Rows) -> Section:
    names = [name for name in (rows[0] if rows else ()) if name.startswith(VERSION)]
    versions = [
        (Cell(name.removeprefix(VERSION)), Cell(", ".join(sorted({str(row[name]) for row in rows if row[name]}))))
        for name in names
    ]
    return Section("versions", "Versions of the software", (table(("", ""), versions),))

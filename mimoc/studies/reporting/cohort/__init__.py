"""The page of a cohort."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from mimoc.base.quantities import quantity_of
from mimoc.render.plots.drawing import draw_svg
from mimoc.studies.cohorts import Cohort
from mimoc.studies.cohorts.cohort import Failure, Progress, Status, status_of
from mimoc.studies.cohorts.store import Store, finished_jobs
from mimoc.studies.cohorts.table import Rows, rows_of
from mimoc.studies.reporting import words
from mimoc.studies.reporting.cohort.children import children
from mimoc.studies.reporting.cohort.measures import OF_CHILDREN, measures_of
from mimoc.studies.reporting.page import Block, Cell, Drawings, Page, Section, TextBlock, number, table
from mimoc.version import __version__

MOST_FACTORS = 6  # Factors that each measure is drawn by.
MOST_PLOTS = 80
MOST_ERRORS = 20  # Different errors that are listed.
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
    """Return the page of a cohort; without the *cohort* itself, jobs that are not done yet are not known."""
    store = Store(folder)
    if cohort:
        store.check()
        jobs, damaged, shown = cohort.jobs(), (), cohort.spec.measure
    else:
        (jobs, damaged), shown = finished_jobs(store), ()
    status, rows = status_of(jobs, store), rows_of(jobs, store, shown, progress)
    sections = [_jobs(status, damaged, is_whole=cohort is not None), children(jobs, store)]
    sections += [_results(rows), _versions(rows)]
    infants = len({str(sorted(job.factors.items(), key=str)) for job in jobs})
    summary = f"{words.count(infants, 'infant')}, {words.count(status.jobs, 'job')}: "
    states = (("ok", "done"), ("failed", "failed"), ("missing", "not done yet"))
    summary += words.listed([f"{count:,} {name}" for state, name in states if (count := status.number(state))])
    return Page(
        kind="A cohort of mimoc",
        title=words.sentence(words.name(jobs[0].cohort if jobs else folder.name)),
        lead=(f"{summary}.",),
        sections=tuple(section for section in sections if section),
        made_by=f"Made by mimoc {__version__}.",
    )


def _jobs(status: Status, damaged: Sequence[str], *, is_whole: bool) -> Section:
    states = ("ok", "failed", "missing")[: 3 if is_whole else 2]
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
    errors: dict[tuple[str, str], list[Failure]] = {}
    for failure in status.failures:
        errors.setdefault((failure.job.step, failure.error), []).append(failure)
    if not errors:
        return
    rows = []
    for (step, error), alike in sorted(errors.items(), key=lambda item: (-len(item[1]), item[0]))[:MOST_ERRORS]:
        first = alike[0]
        who = ", ".join(f"{name} {value}" for name, value in first.job.factors.items())
        log = "/".join(first.log.parts[-3:])
        rows.append((Cell(step), number(f"{len(alike):,}"), Cell(error, "bad"), Cell(who), Cell(log, "code")))
    yield TextBlock(f"{words.count(len(status.failures), 'job')} failed:")
    yield table(("step", "jobs", "error", "the first of these infants", "its log"), rows)
    if len(errors) > MOST_ERRORS:
        yield TextBlock(
            f"{len(errors) - MOST_ERRORS} more errors are in the table that 'mimoc cohort table' writes.", "note"
        )


def _results(rows: Rows) -> Section:
    names = [*rows[0]] if rows else ["seed", "status"]
    factors = [name for name in names[1 : names.index("seed")] if name != "step"]
    factors.sort(key=lambda name: (name == "sex" or name.endswith(OF_CHILDREN), name != "sex"))  # What is varied first.
    after = names[names.index("status") + 1 :]
    columns = [name for name in after if not name.startswith(VERSION) and name not in ("error", "log")]
    drawn, constant, left_out = [], [], dict[str, None]()
    for measure in measures_of([row for row in rows if row["status"] == "ok"], columns):
        if measure.is_constant:
            constant.append(f"{measure.title}: {words.figure(measure.values[0])}")
            continue
        varied = measure.factors(factors)
        left_out |= dict.fromkeys(varied[MOST_FACTORS:])
        drawn += [draw_svg(plot) for factor in varied[:MOST_FACTORS] if (plot := measure.plot(factor))]
    notes = [] if drawn else ["No measure differs between the jobs, or nothing varies that it could be drawn by."]
    if len(drawn) > MOST_PLOTS:
        notes.append(f"{len(drawn) - MOST_PLOTS} more plots are left out.")
    if left_out:
        headings = words.listed([quantity_of(name).heading for name in left_out])
        notes.append(f"Each measure is drawn by at most {MOST_FACTORS} factors; these are left out: {headings}.")
    if constant:
        notes.append(f"The same for all jobs that have it: {'; '.join(constant)}.")
    plots = (Drawings(tuple(drawn[:MOST_PLOTS]), CAPTION),) if drawn else ()
    return Section("results", "Results", (*plots, *(TextBlock(note, "note") for note in notes)))


def _versions(rows: Rows) -> Section:
    names = [name for name in (rows[0] if rows else ()) if name.startswith(VERSION)]
    versions = [
        (Cell(name.removeprefix(VERSION)), Cell(", ".join(sorted({str(row[name]) for row in rows if row[name]}))))
        for name in names
    ]
    return Section("versions", "Versions of the software", (table(("", ""), versions),))

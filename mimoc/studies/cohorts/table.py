"""The table of a cohort, one row a job, and what it says of milestones beside WHO's children.

The table is the same to the byte whoever did the jobs and in whichever order.
"""

import csv
import io
import json
import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import NormalDist, mean, stdev
from typing import Any

from mimoc.base.errors import MimocError, MissingExtraError
from mimoc.base.quantities import MILESTONE_AGES, measures as known_measures
from mimoc.base.rounding import SIGNIFICANT_DIGITS, rounded
from mimoc.bundle.files import write_file
from mimoc.studies.cohorts.infants import build_z
from mimoc.studies.cohorts.job import Job
from mimoc.studies.cohorts.store import Result, Store
from mimoc.studies.milestones import WINDOWS

CSV, PARQUET = "table.csv", "table.parquet"
COLUMNS = ("job", "step", "seed", "status", "error", "log")  # Columns that every table has.
MISSING = "missing"  # Status of a job that is not done yet.

Cell = str | bool | int | float | None
Rows = Sequence[Mapping[str, Cell]]


def rows_of(
    jobs: Sequence[Job],
    store: Store,
    measures: Sequence[str],
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> list[dict[str, Cell]]:
    """Return a row for each job: its factors, step and seed, what was measured, and the versions of the software.

    Without *measures*, every one is shown that any job has; progress is in results read.
    """
    results = list[Result]()
    for job in jobs:
        progress(len(results), len(jobs))
        results.append(store.read(job) or Result(MISSING, {}, {}))
    pairs = [*zip(jobs, results, strict=True)]
    returned = _union([result.measures for job, result in pairs if job.step == "python"])
    known = known_measures()
    others = [name for name in returned if name not in known]
    names = {name for result in results for name in result.measures}
    # Measures in the order in which they are documented, then others by name.
    shown = measures or [*(name for name in known if name in names), *sorted(names - known.keys())]
    factors = _union([job.factors for job in jobs])
    taken = {*COLUMNS, *factors}
    columns = {f"measured.{name}" if name in taken else name: name for name in (*shown, *others)}
    options = varied_options(jobs)
    libraries = _union([result.versions for result in results])
    rows = []
    for job, result in pairs:
        failed = result.status == "failed"
        row = {
            "job": job.key,
            **{name: _cell(job.factors.get(name)) for name in factors},
            "step": job.step,
            **{f"{step}.{name}": _cell(job.options.get(name)) if job.step == step else None for step, name in options},
            "seed": job.seed,
            "status": result.status,
            **{column: _cell(result.measures.get(name)) for column, name in columns.items()},
            **{f"version.{name}": result.versions.get(name) for name in libraries},
            "error": result.error if failed else None,
            "log": store.log(job).relative_to(store.folder).as_posix() if failed else None,
        }
        rows.append(row)
    return rows


def write_csv(rows: Rows, folder: Path) -> Path:
    """Write the table as CSV: empty cells for no value, `true` and `false`, numbers rounded as in all files."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(rows[0] if rows else ())
    writer.writerows([_text(cell) for cell in row.values()] for row in rows)
    return write_file(folder / CSV, text.getvalue().encode())


def write_parquet(rows: Rows, folder: Path) -> Path:
    """Write the table as Parquet, of numbers, truth values and texts; raise a MissingExtraError without pyarrow."""
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise MissingExtraError("pyarrow", "record") from None
    columns = {name: [row[name] for row in rows] for name in (rows[0] if rows else ())}
    arrays = {name: _array(cells, pyarrow) for name, cells in columns.items()}
    buffer = io.BytesIO()
    parquet.write_table(pyarrow.table(arrays), buffer, compression="zstd", version="2.6")
    return write_file(folder / PARQUET, buffer.getvalue())


def _union(mappings: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the keys of all mappings, in the order in which they first occur."""
    return [*dict.fromkeys(name for mapping in mappings for name in mapping)]


def varied_options(jobs: Sequence[Job]) -> list[tuple[str, str]]:
    """Return step and name of the options that differ between the jobs of a step."""
    seen: dict[tuple[str, str], set[str]] = {}
    for job in jobs:
        for name, value in job.options.items():
            seen.setdefault((job.step, name), set()).add(json.dumps(value, sort_keys=True))
    return [where for where, values in seen.items() if len(values) > 1]


def _cell(value: Any) -> Cell:
    return json.dumps(value, sort_keys=True) if isinstance(value, (list, tuple, Mapping)) else value


def _text(cell: Cell) -> str:
    if cell is None:
        return ""
    if isinstance(cell, bool):
        return str(cell).lower()
    # The sum turns -0.0 into 0.
    return f"{cell + 0.0:.{SIGNIFICANT_DIGITS}g}" if isinstance(cell, float) else str(cell)


def _array(cells: Sequence[Cell], pyarrow: Any) -> Any:
    """Return a column of one type: cells of several kinds as numbers, if they are, or else as texts."""
    kinds = {type(cell) for cell in cells if cell is not None}
    if kinds == {int, float}:  # Arrow refuses whole numbers that a float does not hold to the last digit.
        cells = [None if cell is None else float(cell) for cell in cells]
    elif len(kinds) > 1:
        cells = [None if cell is None else _text(cell) for cell in cells]
    return pyarrow.array(cells, None if kinds else pyarrow.string())


SOURCE = "WHO Multicentre Growth Reference Study Group 2006, Acta Paediatr Suppl 450: 86-95"
WHO: Mapping[str, str] = {  # WHO's milestone by the trial that comes nearest to it, whose window has WHO's ages.
    "sit": "sitting without support",
    "hands_and_knees": "hands-and-knees crawling",
    "pull_to_stand": "standing with assistance",
    "stand": "standing alone",
}

DELAYS_SOURCE = "Slining et al. 2010, J Pediatr 157: 20-25, 217 infants of 3 to 18 months"
PUBLISHED_ODDS: Mapping[str, tuple[float, float, float]] = {
    "heavy for length": (1.80, 1.09, 2.97),
    "fat": (2.32, 1.26, 4.29),
}
"""Odds of a delay, relative to all others, and their 95 % interval, by group: each the uppermost tenth, by weight for
length and by skinfolds. A delay was a score of motor development of more than one standard deviation below the mean."""
UPPERMOST = NormalDist().inv_cdf(0.9)  # z-score from which on a child is of a group.
ALL = "all together"


@dataclass(frozen=True, slots=True)
class MilestoneSpread:
    """The ages at which the children of a cohort reach a milestone."""

    trial: str
    n: int  # Children that reach it.
    not_reached: int  # Children that do not, by 24 months.
    mean_months: float | None
    sd_months: float | None
    who: str  # WHO's milestone that comes nearest; empty if there is none.
    who_mean_months: float | None
    who_sd_months: float | None


@dataclass(frozen=True, slots=True)
class DelayOdds:
    """How much more often the children of a group reach a milestone late than all others: later than mean and SD."""

    trial: str
    group: str
    n: int  # Children of the group.
    late: int  # Those of them that are late.
    others: int
    late_others: int
    odds_ratio: float
    low: float  # Lower end of its 95 % interval, by Woolf's method with a half added to each number.
    high: float


@dataclass(frozen=True, slots=True)
class MilestoneSummary:
    """When the children of a cohort reach milestones."""

    spreads: tuple[MilestoneSpread, ...]
    odds: tuple[DelayOdds, ...]
    """Only for drawn children, whose percentiles are known: for each milestone, and for the mean of their z-scores."""
    published_odds: Mapping[str, tuple[float, float, float]]
    who_source: str = SOURCE
    odds_source: str = DELAYS_SOURCE

    def to_data(self) -> dict[str, Any]:
        """Return it as plain data, numbers rounded as in files."""
        return rounded(asdict(self))


def milestone_summary(rows: Rows) -> MilestoneSummary:
    """Return when the children in the table of a cohort reach milestones; raise a MimocError if none are found."""
    children = [row for row in rows if row["step"] == "milestones" and row["status"] == "ok"]
    ages = {trial: [row.get(quantity.name) for row in children] for trial, quantity in MILESTONE_AGES.items()}
    tried = {trial: column for trial, column in ages.items() if f"{trial}_months" in (children[0] if children else ())}
    if not tried:
        raise MimocError("there are no milestones in this cohort; write 'do: [milestones]', and run it")
    scores = {trial: _scores(column) for trial, column in tried.items()}
    scores[ALL] = _scores([mean(of_child) for of_child in zip(*scores.values(), strict=True)])
    return MilestoneSummary(
        tuple(_spread(trial, column) for trial, column in tried.items()), tuple(_odds(children, scores)), PUBLISHED_ODDS
    )


def _spread(trial: str, column: Sequence[Cell]) -> MilestoneSpread:
    reached = [float(age) for age in column if isinstance(age, int | float)]
    average = mean(reached) if reached else None
    deviation = stdev(reached) if len(reached) > 1 else None
    who = WINDOWS[trial] if trial in WHO else None
    ages_of_who = (who.usual_months, who.sd_months) if who else (None, None)
    return MilestoneSpread(
        trial, len(reached), len(column) - len(reached), average, deviation, WHO.get(trial, ""), *ages_of_who
    )


def _scores(column: Sequence[Cell]) -> list[float]:
    """Return how many standard deviations each age lies above the mean; infinity for children that do not succeed."""
    reached = [float(age) for age in column if isinstance(age, int | float) and math.isfinite(age)]
    average, deviation = (mean(reached), stdev(reached) or 1.0) if len(reached) > 1 else (0.0, 1.0)
    return [(float(age) - average) / deviation if isinstance(age, int | float) else math.inf for age in column]


def _odds(children: Rows, scores: Mapping[str, Sequence[float]]) -> Iterator[DelayOdds]:
    for group, of_group in {"heavy for length": _is_heavy, "fat": _is_fat}.items():
        members = [of_group(child) for child in children]
        if None in members or not any(members):
            continue
        for trial, of_trial in scores.items():
            numbers = Counter((member, score > 1) for member, score in zip(members, of_trial, strict=True))
            cells = (numbers[member, late] for member in (True, False) for late in (True, False))
            yield _odds_of(trial, group, *cells)


def _odds_of(trial: str, group: str, late: int, early: int, late_others: int, early_others: int) -> DelayOdds:
    a, b, c, d = (number + 0.5 for number in (late, early, late_others, early_others))
    logarithm = math.log(a * d / (b * c))
    width = NormalDist().inv_cdf(0.975) * math.sqrt(1 / a + 1 / b + 1 / c + 1 / d)
    odds = (math.exp(logarithm + sign * width) for sign in (0, -1, 1))
    return DelayOdds(trial, group, late + early, late, late_others + early_others, late_others, *odds)


def _z(child: Mapping[str, Cell], key: str) -> float | None:
    percentile = child.get(key)
    return NormalDist().inv_cdf(percentile / 100) if isinstance(percentile, int | float) else None


def _is_heavy(child: Mapping[str, Cell]) -> bool | None:
    length, weight = _z(child, "length_percentile"), _z(child, "weight_percentile")
    return None if length is None or weight is None else build_z(length, weight) >= UPPERMOST


def _is_fat(child: Mapping[str, Cell]) -> bool | None:
    fat = _z(child, "fat_percentile")
    return None if fat is None else fat >= UPPERMOST

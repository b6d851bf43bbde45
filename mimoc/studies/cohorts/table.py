"""The table of a cohort: one row a job, the same to the byte whoever did the jobs and in whichever order."""

import csv
import io
import json
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from mimoc.base.errors import MissingExtraError
from mimoc.base.quantities import measures as known_measures
from mimoc.base.rounding import SIGNIFICANT_DIGITS
from mimoc.bundle.files import write_file
from mimoc.studies.cohorts.job import Job
from mimoc.studies.cohorts.store import Result, Store

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
    options, libraries = varied_options(jobs), _union([result.versions for result in results])
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

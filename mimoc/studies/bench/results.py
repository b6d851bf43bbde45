"""What a policy scored, as it stands in files, and tables of several policies."""

import html
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from mimoc.base.errors import BundleError
from mimoc.base.rounding import render_json
from mimoc.bundle.regular_files import UnusableFileError, one_line, read_json_file
from mimoc.schema.base import Model
from mimoc.schema.quantities import Whole
from mimoc.studies.bench.scores import CellScores
from mimoc.studies.bench.table import Cell, bench_table, chosen_cells

EXACT = {"states": "the states of the simulation, though not what is written of them"}
"""What a difference in a score is called, where its name does not say it."""


class BenchResults(Model):
    """What a policy scored in some tasks at some ages."""

    benchmark: str
    """Name of the benchmark, with its version."""
    policy: str
    """The policy, as it was named."""
    policy_files: Mapping[str, str]
    """Digests of the files that decide what it does."""
    seeds: tuple[Whole, Whole]
    """Seeds of the test episodes, the second excluded."""
    software: Mapping[str, str]
    """Versions of mimoc, MuJoCo, NumPy and Python, and the type of the machine."""
    cells: Mapping[str, CellScores]
    """The scores by task and age, such as `reach/9`."""

    @property
    def content(self) -> bytes:
        """The file: JSON with sorted keys and rounded numbers."""
        return render_json(self.model_dump(mode="json"), levels=3)

    @property
    def scored(self) -> Mapping[Cell, CellScores]:
        """The scores by cell, in the order of the benchmark."""
        return {cell: self.cells[cell.name] for cell in chosen_cells() if cell.name in self.cells}


def read_results(path: str | Path) -> BenchResults:
    """Read what a policy scored; raise a BundleError if the file is no such result, or of another benchmark."""
    path, version = Path(path).expanduser(), bench_table().benchmark
    try:
        results = read_json_file(path, BenchResults)
    except UnusableFileError as error:
        raise BundleError(f"{path}: not a result of `mimoc bench`: {error}") from None
    if results is None:
        raise BundleError(f"{path}: there is no such file; name what `mimoc bench -o FILE` wrote")
    if results.benchmark != version:
        raise BundleError(f"{path}: of {results.benchmark!r:.40}, but this mimoc has {version}; enter again")
    if unknown := results.cells.keys() - {cell.name for cell in chosen_cells()}:
        raise BundleError(f"{path}: {version} has no {min(unknown)!r:.40}; enter again")
    return results


def differences(before: CellScores, after: CellScores) -> list[str]:
    """Return how scores differ as they stand in files, a text each; nothing if they are the same to the bit."""
    pairs = {name: (getattr(before, name), getattr(after, name)) for name in CellScores.model_fields}
    written = {name: [render_json(value) for value in pair] for name, pair in pairs.items()}
    other = [name for name, (old, new) in written.items() if old != new]
    if other == ["states"]:
        return [EXACT["states"]]
    short = [name for name in other if name not in ("states", "returns")] or other
    return [f"{name} {_short(pairs[name][0])}, now {_short(pairs[name][1])}" for name in short]


def markdown_tables(entries: Sequence[BenchResults]) -> str:
    """Return two tables in Markdown: how often policies succeed in each task, and the other scores, as means."""
    policies = [_code(entry.policy) for entry in entries]
    lines = [_row("task", "months", *policies), _row("---", *["---:"] * (1 + len(entries)))]
    for cell in chosen_cells():
        if any(cell.name in entry.cells for entry in entries):
            values = [_success(entry.cells.get(cell.name)) for entry in entries]
            lines.append(_row(cell.task, f"{cell.age_months:g}", *values))
    lines.append(_row("**mean**", "", *(_number(_mean(entry, "success")) for entry in entries)))
    headings = ("policy", "cells", "success", "effort", "arc length", "jerk", "likeness")
    lines += ["", _row(*headings), _row("---", *["---:"] * (len(headings) - 1))]
    for policy, entry in zip(policies, entries, strict=True):
        means = [_mean(entry, name) for name in ("success", "effort", "arc_length", "jerk", "likeness")]
        lines.append(_row(policy, f"{len(entry.cells)}", *map(_number, means)))
    return "\n".join(lines)


def _code(text: str) -> str:
    """Return text that anyone may have written as code in a cell of a table; nothing of it is Markdown or HTML."""
    if re.fullmatch(r"[\w +:(){}./,-]+", text, re.ASCII):
        return f"`{text}`"
    special = {ord(character): f"&#{ord(character)};" for character in "`|*_~\\["}
    return f"<code>{html.escape(one_line(text)).translate(special)}</code>"


def _success(scores: CellScores | None) -> str:
    if scores is None:
        return ""
    if scores.success is None or scores.success_95 is None:
        return f"distance {_number(scores.likeness)}"
    low, high = scores.success_95
    return f"{scores.success:.2f} ({low:.2f}-{high:.2f})"


def _mean(entry: BenchResults, name: str) -> float | None:
    values = [value for scores in entry.scored.values() if (value := getattr(scores, name)) is not None]
    return math.fsum(values) / len(values) if values else None


def _number(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"


def _short(value: object) -> str:
    return f"{value:.9g}" if isinstance(value, float) else f"{value}"[:60]


def _row(*items: str) -> str:
    return f"| {' | '.join(items)} |"

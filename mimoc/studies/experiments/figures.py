"""The paper's figures, each with how surely it is known, beside what was measured."""

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

Measured = Mapping[str, float | str | None]
"""What was measured, by the name of the quantity; None for what is never reached."""

FIGURES = Path(__file__).parent / "pages" / "figures.csv"


@dataclass(frozen=True, slots=True)
class Figure:
    """What the paper has of a quantity."""

    quantity: str  # Its name and unit, or a statement that holds or does not.
    paper: str  # A number as it is given, or a word.
    certainty: str  # `S`: read in the paper or its code; `D`: derived from them; `M`: from memory.
    source: str  # Where in the paper or its code.

    def row(self, measured: float | str | None) -> tuple[str, ...]:
        """Return its row of the table; numbers measured have a digit more than the paper's."""
        if isinstance(measured, str | None):
            ours = "never" if measured is None else measured
            return self.quantity, self.paper, ours, "" if ours == self.paper else "differs", self._known
        decimals = self.paper.partition(".")[2]
        digits = len(decimals) + 1 if decimals else 0
        sign = "+" if self.paper[0] in "+-" else ""
        difference = measured - float(self.paper)
        return self.quantity, self.paper, f"{measured:{sign}z.{digits}f}", f"{difference:+z.{digits}f}", self._known

    @property
    def _known(self) -> str:
        return f"{self.certainty}: {self.source}"


@cache
def figures_of(experiment: str) -> tuple[Figure, ...]:
    """Return the paper's figures that an experiment is compared with."""
    with FIGURES.open(encoding="utf-8", newline="") as file:
        rows = [row for row in csv.DictReader(file) if row.pop("experiment") == experiment]
    return tuple(Figure(**row) for row in rows)


def figure_rows(experiment: str, measured: Measured) -> Iterator[tuple[str, ...]]:
    """Yield a row for each of the paper's figures that was measured, of which small versions measure fewer."""
    for figure in figures_of(experiment):
        if figure.quantity in measured:
            yield figure.row(measured[figure.quantity])


def yes(is_so: bool) -> str:
    """Return whether a statement holds, as a word of the table."""
    return "yes" if is_so else "no"

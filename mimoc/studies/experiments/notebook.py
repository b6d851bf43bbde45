"""What experiments share: a child, the paper's figures beside what was measured, and a folder for the report."""

import csv
import io
import itertools
import math
import os
import platform
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, TypeVar

from mimoc.base.errors import OutputError
from mimoc.bundle.files import write_file
from mimoc.render.plots.file import encode
from mimoc.render.plots.plot import Plot, Sheet
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development


def child(name: str, age_months: float, **keys: Any) -> InfantSpec:
    """Return the spec of a child whose further keys are as in a file."""
    return InfantSpec.model_validate({"mimoc": 1, "name": name, "age_months": age_months, **keys})


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


Progress = Callable[[int, int], None]  # Called with the number of steps done and their total.
T = TypeVar("T")
Cell = str | float | None  # Cell of a table; None for an empty one.

LIBRARIES = ("mimoc", "mujoco", "numpy")  # Libraries whose versions every report names.
NOT_TEXT = ("#", "|", "-", "!", "    ")
"""First characters of Markdown blocks that are not paragraphs: headings, tables, lists, images, code."""
COLUMNS = 120
DIGITS = 6  # Significant digits of numbers in tables.
LAWS: Mapping[Development, str] = {
    "published": "MIMo v2's body (`development: published`)",
    "maturing": "mimoc's own body (`development: maturing`)",
}
OTHER_BODY = (
    "This is not the paper's body. `mimoc experiment {name} --development published` runs the experiment on it, and "
    "shows the paper's figures beside ours."
)


@dataclass(frozen=True, slots=True)
class Notebook:
    """The output folder of an experiment; all files are written atomically."""

    name: str  # Name of the experiment.
    folder: Path
    quick: bool  # Whether to run a smaller version of the experiment.
    progress: Progress
    development: Development | None = None
    """Law of development of its infants; None if the experiment has laws of its own."""
    bodies: str = ""  # Digest of the bodies of its infants, `studies.bodies.bodies_digest`.

    @property
    def law(self) -> Development:
        """The law of development of the infants of an experiment that can have either."""
        assert self.development is not None
        return self.development

    def counter(self, total: int) -> Callable[[T], T]:
        """Return a function that counts one of some steps and gives back what it is given."""
        steps = itertools.count(1)

        def count(result: T) -> T:
            self.progress(next(steps), total)
            return result

        return count

    def part(self, before: int, size: int, total: int) -> Progress:
        """Return what is told the progress of one part, of as many steps as its size, after those before it."""
        return lambda done, _: self.progress(before + min(done, size), total)

    def write_table(self, file: str, heading: str, rows: Iterable[Sequence[Cell]]) -> None:
        """Write a CSV with a heading of names separated by commas; the same numbers give the same bytes."""
        text = io.StringIO()
        lines = csv.writer(text, lineterminator="\n")
        lines.writerow(heading.split(","))
        lines.writerows([_number(cell) for cell in row] for row in rows)
        write_file(self.folder / file, text.getvalue().encode())

    def write_picture(self, file: str, png: bytes) -> None:
        """Write a PNG; raise an OutputError if it cannot be written."""
        write_file(self.folder / file, png)

    def write_plots(self, file: str, plots: Sequence[Plot]) -> None:
        """Write plots side by side as a PNG; raise an OutputError if it cannot be written."""
        self.write_picture(file, encode(Sheet(tuple(plots))))

    def write_page(self, measured: Measured | None, /, *libraries: str, **numbers: object) -> Path:
        """Write the report, the text of `pages/NAME.md` with numbers and tables by their names; and how to redo it.

        What was measured of quantities in `pages/figures.csv` is shown beside the paper's figures, of the paper's body,
        with the text of `pages/NAME_published.md`. The results depend on further *libraries*.
        """
        law = f" --development {self.development}" if self.development else ""
        command = f"mimoc experiment {self.name} -o {self.folder.resolve().name}{law}{' --quick' * self.quick}"
        versions = ", ".join(f"{library} {version(library)}" for library in (*LIBRARIES, *libraries, "matplotlib"))
        machine = f"Python {platform.python_version()} on {platform.machine()}"
        numbers["reproduction"] = f"    {command}\n\nWith {versions} and {machine}. Bodies: `{self.bodies}`."
        if self.development:
            numbers["law"] = LAWS[self.development]
            numbers["beside"] = OTHER_BODY.format(name=self.name)
        if self.development == "published":
            rows, differs = figure_rows(self.name, measured or {}), page_text(f"{self.name}_published", **numbers)
            numbers["beside"] = page_text("figures", rows=table_rows(rows), differs=differs)
        page = "\n\n".join(map(_wrapped, page_text(self.name, **numbers).split("\n\n"))) + "\n"
        return write_file(self.folder / f"{self.name}.md", page.encode())


def open_notebook(
    name: str,
    folder: str | Path,
    *,
    quick: bool,
    development: Development | None = None,
    progress: Progress | None = None,
) -> Notebook:
    """Return the notebook for a folder, which is created if necessary; raise an OutputError if it cannot be created."""
    path = Path(os.path.expanduser(folder))
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise OutputError(f"{path}: is a file, not a folder; choose another folder") from None
    except OSError as error:
        raise OutputError(f"{path}: cannot be created ({error.strerror}); choose another folder") from None
    except ValueError:
        raise OutputError(f"{str(path)!r}: a folder cannot have this name; choose another folder") from None
    return Notebook(name, path, quick, progress or (lambda done, total: None), development)


def page_text(name: str, **numbers: object) -> str:
    """Return the text of `pages/NAME.md`, its numbers filled in by `str.format`."""
    return (Path(__file__).parent / "pages" / f"{name}.md").read_text(encoding="utf-8").strip("\n").format(**numbers)


def markdown_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    return table_rows([headings, ["---"] * len(headings), *rows])


def table_rows(rows: Iterable[Sequence[str]]) -> str:
    """Return the rows of a table in Markdown whose headings are in the text of the page."""
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def _wrapped(block: str) -> str:
    """Return a block of Markdown, wrapped if it is a paragraph."""
    text = block.strip("\n")
    if text.startswith(NOT_TEXT):
        return text
    return textwrap.fill(text, COLUMNS, break_long_words=False, break_on_hyphens=False)


def _number(cell: Cell) -> str:
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return ""
    return cell if isinstance(cell, str) else f"{cell:.{DIGITS}g}"

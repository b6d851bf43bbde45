"""The output folder of an experiment: tables, figures and a report."""

import csv
import io
import math
import os
import platform
import re
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from mimoc.base.errors import OutputError
from mimoc.bundle.files import write_file
from mimoc.render.plots.file import encode
from mimoc.render.plots.plot import Plot, Sheet

Progress = Callable[[int, int], None]
"""Called with the number of steps done and their total."""
Cell = str | float | None
"""Cell of a table; None for an empty one."""

LIBRARIES = ("mimoc", "mujoco", "numpy")
"""Libraries whose versions every report names."""
NOT_TEXT = ("#", "|", "-", "!", "    ")
"""First characters of Markdown blocks that are not paragraphs: headings, tables, lists, images, code."""
COLUMNS = 120
DIGITS = 6
"""Significant digits of numbers in tables."""


@dataclass(frozen=True, slots=True)
class Notebook:
    """The output folder of an experiment; all files are written atomically."""

    name: str
    """Name of the experiment."""
    folder: Path
    quick: bool
    """Whether to run a smaller version of the experiment."""
    progress: Progress

    def write_table(self, file: str, headings: Sequence[str], rows: Iterable[Sequence[Cell]]) -> None:
        """Write a CSV; the same numbers give the same bytes.

        Raises:
            OutputError: If it cannot be written.
        """
        text = io.StringIO()
        lines = csv.writer(text, lineterminator="\n")
        lines.writerow(headings)
        lines.writerows([_number(cell) for cell in row] for row in rows)
        write_file(self.folder / file, text.getvalue().encode())

    def write_picture(self, file: str, png: bytes) -> None:
        """Write a PNG.

        Raises:
            OutputError: If it cannot be written.
        """
        write_file(self.folder / file, png)

    def write_plots(self, file: str, plots: Sequence[Plot]) -> None:
        """Write plots side by side as a PNG.

        Raises:
            OutputError: If it cannot be written.
        """
        self.write_picture(file, encode(Sheet(tuple(plots))))

    def write_page(self, title: str, sections: Iterable[str], *, seeds: str, libraries: Sequence[str] = ()) -> Path:
        """Write the report, which ends with how to reproduce it.

        Args:
            title: Title of the report.
            sections: Its sections, in Markdown.
            seeds: A sentence on the seeds.
            libraries: Further libraries that the results depend on.

        Raises:
            OutputError: If it cannot be written.
        """
        blocks = "\n\n".join((f"# {title}", *sections, self._reproduction(seeds, libraries))).split("\n\n")
        page = "\n\n".join(map(_wrapped, blocks)) + "\n"
        return write_file(self.folder / f"{self.name}.md", page.encode())

    def _reproduction(self, seeds: str, libraries: Sequence[str]) -> str:
        """Return the section on how to reproduce the results."""
        command = f"mimoc experiment {self.name} -o {self.folder.resolve().name}{' --quick' * self.quick}"
        versions = ", ".join(f"{library} {version(library)}" for library in (*LIBRARIES, *libraries))
        machine = f"Python {platform.python_version()} on {platform.machine()}"
        return f"## Reproduction\n\n    {command}\n\nWith {versions} and {machine}. {seeds}"


def open_notebook(name: str, folder: str | Path, *, quick: bool, progress: Progress | None = None) -> Notebook:
    """Return the notebook for a folder, which is created if necessary.

    Raises:
        OutputError: If the folder cannot be created.
    """
    path = Path(os.path.expanduser(folder))
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise OutputError(f"{path}: is a file, not a folder; choose another folder") from None
    except OSError as error:
        raise OutputError(f"{path}: cannot be created ({error.strerror}); choose another folder") from None
    except ValueError:
        raise OutputError(f"{str(path)!r}: a folder cannot have this name; choose another folder") from None
    return Notebook(name, path, quick, progress or (lambda done, total: None))


def page_texts(name: str) -> Mapping[str, str]:
    """Return the texts of a page by their names in `pages/NAME.md`; `str.format` fills in their numbers."""
    text = (Path(__file__).parent / "pages" / f"{name}.md").read_text(encoding="utf-8")
    _, *parts = re.split(r"^<!-- (\w+) -->\n", text, flags=re.MULTILINE)
    return {key: part.strip("\n") for key, part in zip(parts[::2], parts[1::2], strict=True)}


def markdown_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


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

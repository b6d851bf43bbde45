"""The folder that an experiment writes into: tables, pictures, and one page about them."""

import csv
import io
import math
import os
import platform
import textwrap
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

from mimoc.bundle.files import write_file
from mimoc.errors import OutputError

Progress = Callable[[int, int], None]
"""Told how much is done, and of how much."""
Cell = str | float | None
"""Of a table; None where there is nothing to say."""

LIBRARIES = ("mimoc", "mujoco", "numpy")
"""Whose versions every page names."""
NOT_TEXT = ("#", "|", "-", "!", "    ")
"""How what is no paragraph of text begins in Markdown: headings, tables, lists, pictures, code."""
COLUMNS = 120
DIGITS = 6
"""Significant ones of a number in a table."""


@dataclass(frozen=True, slots=True)
class Notebook:
    """Where an experiment leaves what it finds; each file is whole as soon as it is there."""

    name: str
    """Of the experiment."""
    folder: Path
    quick: bool
    """Whether a smaller experiment is wanted."""
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

    def write_page(self, title: str, sections: Iterable[str], *, seeds: str, libraries: Sequence[str] = ()) -> Path:
        """Write the page, with how it was made at its end.

        Args:
            title: Its heading.
            sections: Markdown, one after the other.
            seeds: What they are, as a sentence.
            libraries: Others that the results depend on.

        Raises:
            OutputError: If it cannot be written.
        """
        blocks = "\n\n".join((f"# {title}", *sections, self._making(seeds, libraries))).split("\n\n")
        page = "\n\n".join(map(_wrapped, blocks)) + "\n"
        return write_file(self.folder / f"{self.name}.md", page.encode())

    def _making(self, seeds: str, libraries: Sequence[str]) -> str:
        """Return the section on how the results were made."""
        command = f"mimoc experiment {self.name} -o {self.folder.resolve().name}{' --quick' * self.quick}"
        versions = ", ".join(f"{library} {version(library)}" for library in (*LIBRARIES, *libraries))
        machine = f"Python {platform.python_version()} on {platform.machine()}"
        return f"## How it was made\n\n    {command}\n\nWith {versions} and {machine}. {seeds}"


def open_notebook(name: str, folder: str | Path, *, quick: bool, progress: Progress | None = None) -> Notebook:
    """Return the notebook in a folder, which is made if need be.

    Raises:
        OutputError: If it cannot be.
    """
    path = Path(os.path.expanduser(folder))
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise OutputError(f"{path}: is a file, not a folder; choose another place") from None
    except OSError as error:
        raise OutputError(f"{path}: cannot be made ({error.strerror}); choose another place") from None
    except ValueError:
        raise OutputError(f"{str(path)!r}: a folder cannot have this name; choose another place") from None
    return Notebook(name, path, quick, progress or (lambda done, total: None))


def markdown_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table as Markdown has it."""
    lines = [headings, ["---"] * len(headings), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _wrapped(block: str) -> str:
    """Return a block of Markdown with lines of an even length, if it is a paragraph of text."""
    text = block.strip("\n")
    if text.startswith(NOT_TEXT):
        return text
    return textwrap.fill(text, COLUMNS, break_long_words=False, break_on_hyphens=False)


def _number(cell: Cell) -> str:
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return ""
    return cell if isinstance(cell, str) else f"{cell:.{DIGITS}g}"

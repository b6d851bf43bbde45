"""The folder of an experiment: its tables, pictures and page, and the digest of the bodies that the page names."""

import csv
import io
import itertools
import math
import os
import textwrap
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TypeVar
from xml.etree.ElementTree import canonicalize

from mimoc.base.errors import OutputError
from mimoc.bundle.files import write_file
from mimoc.bundle.io import Bundle
from mimoc.compiler.building import compiled
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import Development
from mimoc.studies.jobs import Progress

T = TypeVar("T")
Cell = str | float | None  # Cell of a table; None for an empty one.

PAGES = Path(__file__).parent / "experiments" / "pages"
NOT_TEXT = ("#", "|", "-", "!", "    ")
"""First characters of Markdown blocks that are not paragraphs: headings, tables, lists, images, code."""
COLUMNS = 120
DIGITS = 6  # Significant digits of numbers in tables.


@dataclass(frozen=True, slots=True)
class Notebook:
    """The output folder of an experiment, and how it is run; all files are written atomically."""

    name: str  # Name of the experiment.
    folder: Path
    quick: bool  # Whether to run a smaller version of the experiment.
    progress: Progress
    development: Development | None = None
    """Law of development of its infants; None if the experiment has laws of its own."""

    @property
    def law(self) -> Development:
        """The law of development of the infants of an experiment that can have either."""
        assert self.development is not None
        return self.development

    def counter(self, total: int) -> Callable[[T], T]:
        """Return a function that counts one of some steps and returns its argument."""
        steps = itertools.count(1)

        def count(result: T) -> T:
            self.progress(next(steps), total)
            return result

        return count

    def part(self, before: int, size: int, total: int) -> Progress:
        """Return the progress of one part, of as many steps as its size, after those before it."""
        return lambda done, _: self.progress(before + min(done, size), total)

    def write_table(self, file: str, heading: str, rows: Iterable[Sequence[Cell]]) -> None:
        """Write a CSV with a heading of names separated by commas; the same numbers give the same bytes."""
        text = io.StringIO()
        lines = csv.writer(text, lineterminator="\n")
        lines.writerow(heading.split(","))
        lines.writerows([_number(cell) for cell in row] for row in rows)
        write_file(self.folder / file, text.getvalue().encode())

    def write_page(self, text: str) -> Path:
        """Write the report in Markdown, its paragraphs wrapped, and return its path."""
        page = "\n\n".join(map(_wrapped, text.split("\n\n"))) + "\n"
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
    return (PAGES / f"{name}.md").read_text(encoding="utf-8").strip("\n").format(**numbers)


def markdown_table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table in Markdown."""
    return table_rows([headings, ["---"] * len(headings), *rows])


def table_rows(rows: Iterable[Sequence[str]]) -> str:
    """Return the rows of a table in Markdown whose headings are in the text of the page."""
    return "\n".join(f"| {' | '.join(row)} |" for row in rows)


def yes(is_so: bool) -> str:
    """Return whether a statement holds, as a word of the table."""
    return "yes" if is_so else "no"


def months_text(age_months: float) -> str:
    """Return an age as text: `1 month`, `3.5 months`."""
    return f"{age_months:g} month{'s' * (age_months != 1)}"


def _wrapped(block: str) -> str:
    text = block.strip("\n")
    if text.startswith(NOT_TEXT):
        return text
    return textwrap.fill(text, COLUMNS, break_long_words=False, break_on_hyphens=False)


def _number(cell: Cell) -> str:
    if cell is None or (isinstance(cell, float) and math.isnan(cell)):
        return ""
    return cell if isinstance(cell, str) else f"{cell:.{DIGITS}g}"


STILL = {"asset", "camera", "deformable", "light", "sensor", "site", "statistic", "visual"}
"""Elements of MJCF that move nothing: how a scene looks, and what is only read."""
NAMES = {"model", "material", "rgba", "group"}
"""Attributes that move nothing: the name of the infant, and how a geom looks."""
DIGEST_DIGITS = 16


def bodies_digest(infants: Iterable[Bundle | InfantSpec]) -> str:
    """Return 16 hexadecimal digits that say with which bodies something was measured.

    They are those of the scenes that are simulated, in the order given: masses, shapes, joints, motors, contacts, start
    poses and furniture, with the digits of bundles, which are the same on every machine. Names of infants, looks,
    sensors and sites, manifests and versions are left out.

    Raises:
        SpecError: If an infant cannot be built.

    Example:
        >>> from mimoc.schema.infant import load_spec
        >>> spec = load_spec("nine_months.yaml")
        >>> bodies_digest([spec]) == bodies_digest([spec.with_(name="another")])
        True
        >>> bodies_digest([spec]) == bodies_digest([spec.with_(age_months=10)])
        False
    """
    digest = sha256()
    for bundle in map(compiled, infants):
        scene = bundle.files[bundle.manifest.scene].decode()
        moved = canonicalize(scene, strip_text=True, exclude_tags=STILL, exclude_attrs=NAMES)
        digest.update(moved.encode())
    return digest.hexdigest()[:DIGEST_DIGITS]

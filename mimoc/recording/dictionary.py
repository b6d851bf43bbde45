"""The data dictionary of a recording, `columns.csv`: what each of its movement columns is."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from mimoc.base.errors import RecordingError
from mimoc.bundle.files import write_file
from mimoc.bundle.regular_files import UnusableFileError, read_regular_file
from mimoc.recording.movement_columns.column import Column

DICTIONARY = "columns.csv"
HEADINGS = ("name", "unit", "about", "frame", "source")
MOST_BYTES = 2**23
"""Of a dictionary; an infant with five fingers and muscles has 0.2 MB."""


def write_dictionary(folder: Path, columns: Iterable[Column]) -> None:
    """Write what columns are beside what the folder's dictionary says of others, or raise an OutputError."""
    entries = read_dictionary(folder) | {
        column.name: {heading: str(getattr(column, heading)) for heading in HEADINGS} for column in columns
    }
    write_file(folder / DICTIONARY, table_text(HEADINGS, entries.values()))


def read_dictionary(folder: Path) -> dict[str, Mapping[str, str]]:
    """Return what the dictionary of a recording says of each column, by name; nothing if there is none."""
    path = folder / DICTIONARY
    try:
        content = read_regular_file(path, MOST_BYTES, below=folder)
        rows = [*csv.DictReader(io.StringIO((content or b"").decode()), strict=True)]
    except UnusableFileError as error:
        raise RecordingError(f"{path}: {error}") from None
    except (UnicodeDecodeError, csv.Error):
        raise RecordingError(f"{path}: the file is damaged") from None
    if any(tuple(row) != HEADINGS or None in row.values() for row in rows):
        raise RecordingError(f"{path}: its columns must be {', '.join(HEADINGS)}")
    return {row["name"]: row for row in rows}


def table_text(headings: Sequence[str], rows: Iterable[Mapping[str, str]]) -> bytes:
    """Return a table as CSV."""
    text = io.StringIO()
    writer = csv.DictWriter(text, headings, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue().encode()

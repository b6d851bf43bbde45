"""A recording as tidy tables of text."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from pyarrow import csv

from mimoc.recording.exporters.tidy_tables import export_tables
from mimoc.recording.reading import ReadRecording


def export(recording: ReadRecording, out: Path, progress: Callable[[int, int], None]) -> list[str]:
    """Write `.csv` files; numbers have all the digits that they have in the recording."""

    def open_table(path: Path, schema: Any) -> Any:
        return csv.CSVWriter(f"{path}.csv", schema)

    return export_tables(recording, out, progress, open_table)

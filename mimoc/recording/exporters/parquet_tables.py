"""A recording as tidy tables of Parquet."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pyarrow.parquet as pq

from mimoc.recording.exporters.tidy_tables import export_tables
from mimoc.recording.reading import ReadRecording


def export(recording: ReadRecording, out: Path, progress: Callable[[int, int], None]) -> list[str]:
    """Write `.parquet` files, with the columns that tables of text have."""

    def open_table(path: Path, schema: Any) -> Any:
        return pq.ParquetWriter(f"{path}.parquet", schema, compression="zstd")

    return export_tables(recording, out, progress, open_table)

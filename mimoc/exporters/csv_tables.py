"""A recording as tables of text."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import csv

from mimoc.recording.columns import OBSERVATION
from mimoc.recording.reading import ReadRecording
from mimoc.recording.tables import sparse_of


def export(recording: ReadRecording, out: Path, progress: Callable[[int, int], None]) -> list[str]:
    """Write a table for each episode, one of touch with a row for each number that is not zero, and a list of all."""

    def write(name: str, columns: Mapping[str, Any]) -> None:
        csv.write_csv(pa.table({key: pa.array(values) for key, values in columns.items()}), out / f"{name}.csv")

    notes = dict[str, None]()
    for done, episode in enumerate(recording):
        progress(done, len(recording))
        name = episode.files.stems[0].name
        write(name, episode.columns())
        for reading in episode.described.readings:
            if reading.kind == "picture":
                notes[f"'{reading.name}' is left out: a table cannot hold pictures"] = None
            elif reading.kind == "sparse":
                rows, index, value = sparse_of(episode.table, OBSERVATION + reading.name)
                layout = reading.layout or [str(number) for number in range(reading.size)]
                columns = {"step": episode.step[rows], "name": np.array(layout)[index], "value": value}
                write(f"{name}.{reading.name}", columns)
                notes[f"'{reading.name}' is in tables of its own, without the numbers that are zero"] = None
    write("episodes", recording.summary())
    return [*notes, "states and what was done besides control steps are left out: a table cannot hold them"]

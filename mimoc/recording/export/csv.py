"""A recording as tables of text."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from pyarrow import csv

from mimoc.recording.described import OBSERVATION
from mimoc.recording.reading import Episode, ReadRecording
from mimoc.recording.table_check import sparse_of


def export_csv(
    recording: ReadRecording, episodes: Sequence[Episode], out: Path, progress: Callable[[int, int], None]
) -> list[str]:
    """Write a table for each episode, one of touch with a row for each number that is not zero, and a list of all.

    Returns:
        What a table cannot hold.
    """
    notes = dict[str, None]()
    for done, episode in enumerate(episodes):
        progress(done, len(episodes))
        name = episode.files.stems[0].name
        _write(out / f"{name}.csv", episode.columns())
        for reading in episode.described.readings:
            if reading.kind == "picture":
                notes[f"'{reading.name}' is left out: a table cannot hold pictures"] = None
            elif reading.kind == "sparse":
                rows, index, value = sparse_of(episode.table, OBSERVATION + reading.name)
                layout = reading.layout or [str(number) for number in range(reading.size)]
                columns = {"step": episode.step[rows], "name": np.array(layout)[index], "value": value}
                _write(out / f"{name}.{reading.name}.csv", columns)
                notes[f"'{reading.name}' is in tables of its own, without the numbers that are zero"] = None
    _write(out / "episodes.csv", recording.summary())
    return [*notes, "states and what was done besides control steps are left out: a table cannot hold them"]


def _write(path: Path, columns: Mapping[str, Any]) -> None:
    csv.write_csv(pa.table({name: pa.array(values) for name, values in columns.items()}), path)

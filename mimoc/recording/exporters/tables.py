"""A recording as tidy tables: a row for each time, a column for each quantity, and a dictionary of all columns."""

import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from pyarrow import csv

from mimoc.base.quantities import QUANTITIES
from mimoc.recording.columns import ACTION, OBSERVATION, Array
from mimoc.recording.folder import DICTIONARY, HEADINGS, read_dictionary, table_text
from mimoc.recording.reading import Episode, ReadRecording
from mimoc.recording.tables import MEASURE, sparse_of

Opened = Callable[[Path, Any], Any]
"""Opens a table to be written, given its path without extension and its schema; it has `write_table` and `close`."""
MOVEMENT, EPISODES = "movement", "episodes"
KEYS = {
    "infant": "which of the infants that were recorded side by side, from 0",
    "episode": "number of the episode of this infant, from 0",
    "step": "control steps since the episode began",
    "time_s": "simulated time",
}
"""The first columns of each table."""
STEPS = {
    "reward": "reward of the control step",
    "terminated": "whether the control step ended the episode",
    "truncated": "whether it was the last one allowed",
    "name": "what is felt where",
    "value": "how much; all others are zero",
}
SUMMARY = {
    "steps": "control steps",
    "ended": "how it ended: terminated, truncated, by a reset, closed or unfinished",
    "seed": "seed of its reset; empty if random numbers went on",
    "return": "sum of rewards",
    "is_success": "whether it was successful at any time",
}
GROUPS = {"info.": "what the control step's info says", "term.": "term of the reward"}
UNIT = re.compile(r"(.*?)(?: \[(.*)\])?", re.DOTALL)  # A name with its unit in brackets, as layouts of senses have it.


def export_csv(recording: ReadRecording, out: Path, progress: Callable[[int, int], None]) -> list[str]:
    """Write `.csv` files; numbers have all the digits that they have in the recording."""
    return _export(recording, out, progress, lambda path, schema: csv.CSVWriter(f"{path}.csv", schema))


def export_parquet(recording: ReadRecording, out: Path, progress: Callable[[int, int], None]) -> list[str]:
    """Write `.parquet` files, with the columns that tables of text have."""

    def open_table(path: Path, schema: Any) -> Any:
        return pq.ParquetWriter(f"{path}.parquet", schema, compression="zstd")

    return _export(recording, out, progress, open_table)


def _export(recording: ReadRecording, out: Path, progress: Callable[[int, int], None], open_table: Opened) -> list[str]:
    """Write movement of all episodes, a table for each episode, one of touch without zeros, and a list of all.

    Cells are empty where there is no number, such as of a limb that an infant does not have.
    """
    entries = dict[tuple[str, str], Mapping[str, str]]()

    def write(name: str, kind: str, columns: Mapping[str, Any], described: Mapping[str, Mapping[str, str]]) -> None:
        table = pa.table({column: _filled(values) for column, values in columns.items()})
        with closing(open_table(out / name, table.schema)) as file:
            file.write_table(table)
        entries.update({(kind, column): described.get(column) or _entry(column) for column in columns})

    entries.update(_write_movement(recording, out, open_table))
    notes = dict[str, None]()
    for done, episode in enumerate(recording):
        progress(done, len(recording))
        name, keys = episode.files.stems[0].name, _keys(episode)
        senses = [reading.name for reading in episode.described.readings if reading.kind == "dense"]
        write(name, "INFANT-EPISODE", keys | episode.columns(ACTION, *senses), {})
        for reading in episode.described.readings:
            if reading.kind == "picture":
                notes[f"'{reading.name}' is left out: a table cannot hold pictures"] = None
            elif reading.kind == "sparse":
                rows, index, value = sparse_of(episode.table, OBSERVATION + reading.name)
                layout = reading.layout or [str(number) for number in range(reading.size)]
                felt = {key: values[rows] for key, values in keys.items()}
                felt |= {"step": episode.step[rows], "name": np.array(layout)[index], "value": value}
                write(f"{name}.{reading.name}", f"INFANT-EPISODE.{reading.name}", felt, {})
                notes[f"'{reading.name}' is in tables of its own, without the numbers that are zero"] = None
    write(EPISODES, EPISODES, recording.summary(), {name: _said(name, about) for name, about in SUMMARY.items()})
    (out / DICTIONARY).write_bytes(table_text(("table", *HEADINGS), _rows(entries)))
    return [*notes, "states and what was done besides control steps are left out: a table cannot hold them"]


def _write_movement(recording: ReadRecording, out: Path, open_table: Opened) -> dict[Any, Mapping[str, str]]:
    """Write the movement columns of all episodes as one table; return what each of its columns is."""
    described = [episode.described for episode in recording]
    numbers = dict.fromkeys(name for item in described for name in item.movement)
    texts = dict.fromkeys(name for item in described for name in item.movement_names if name not in numbers)
    if not numbers and not texts:
        return {}
    kinds = {"infant": pa.int64(), "episode": pa.int64(), "step": pa.int64(), "time_s": pa.float64()}
    kinds |= dict.fromkeys(numbers, pa.float32()) | dict.fromkeys(texts, pa.string())
    with closing(open_table(out / MOVEMENT, pa.schema(kinds.items()))) as file:
        for episode in recording:
            columns = _keys(episode) | {"step": episode.step, "time_s": episode.time_s} | dict(episode.movement)
            missing = [None] * len(episode.step)
            arrays = [
                _filled(columns[name], kind) if name in columns else pa.array(missing, kind)
                for name, kind in kinds.items()
            ]
            file.write_table(pa.table(arrays, schema=pa.schema(kinds.items())))
    dictionary = read_dictionary(recording.path)
    return {(MOVEMENT, name): dictionary.get(name) or _entry(name) for name in kinds}


def _keys(episode: Episode) -> dict[str, Array]:
    return {
        name: np.full(len(episode.step), getattr(episode, "number" if name == "episode" else name))
        for name in ("infant", "episode")
    }


def _filled(values: Any, kind: Any = None) -> Any:
    return pa.array(values, kind, from_pandas=True)


def _entry(column: str) -> dict[str, str]:
    if column.startswith(MEASURE) and (quantity := QUANTITIES.get(column.removeprefix(MEASURE))):
        return {"name": column, "unit": quantity.unit, "about": quantity.about, "source": quantity.source or ""}
    of_group = next((text for prefix, text in GROUPS.items() if column.startswith(prefix)), None)
    if about := of_group or KEYS.get(column) or STEPS.get(column):
        return _said(column, about)
    match = UNIT.fullmatch(column)
    label, unit = match.groups() if match else (column, None)
    return {"name": column, "unit": unit or "", "about": label.replace(f"{ACTION}: ", "command of the actuator ", 1)}


def _said(name: str, about: str) -> dict[str, str]:
    return {"name": name, "unit": "s" if name.endswith("_s") else "", "about": about}


def _rows(entries: Mapping[tuple[str, str], Mapping[str, str]]) -> Iterator[dict[str, str]]:
    for (table, name), entry in entries.items():
        yield {"table": table, **dict.fromkeys(HEADINGS, ""), **entry, "name": name}

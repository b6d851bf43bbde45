"""Recordings made to do harm: every way that was ever found, small, by code.

Each changes the folder of an honest recording of one infant. `CRAFTED` says what mimoc answers.
"""

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from mimoc.recording.video import require_av

Craft = Callable[[Path, Path], None]
"""Changes the folder of a recording; the other path is a folder outside of it, with canaries."""
WHOLE, PART = "episodes/0000-000000", "episodes/0000-000002.0001"
TOUCH, ANGLES = "observation.touch", "observation.proprioception"


def _table(change: Callable[[Any], Any], path: str = f"{WHOLE}.parquet") -> Craft:
    def craft(folder: Path, outside: Path) -> None:
        pq.write_table(change(pq.read_table(folder / path)), folder / path)

    return craft


def _column(name: str, change: Callable[[Any], Any], path: str = f"{WHOLE}.parquet", nullable: bool = False) -> Craft:
    def replace(table: Any) -> Any:
        column = change(table.column(name).combine_chunks())
        field = pa.field(name, column.type, nullable)
        return table.set_column(table.column_names.index(name), field, column)

    return _table(replace, path)


def _values(name: str, change: Callable[[Any], Any], path: str = f"{WHOLE}.parquet") -> Craft:
    """Return what changes the rows of a column, as Python's values, and leaves its type."""
    return _column(name, lambda column: pa.array(change(column.to_pylist()), column.type), path)


def _lists(column: Any, size: int) -> Any:
    return pa.array([row[:size] for row in column.to_pylist()], pa.list_(column.type.value_field, size))


def _pairs(column: Any, number: Any, *names: str) -> Any:
    """Return a sparse column with other names of its parts and another type of its values."""
    fields = [pa.field(names[0], pa.int32(), False), pa.field(names[1], number, False)]
    kind = pa.list_(pa.field("element", pa.struct(fields), False))
    rows = [[dict(zip(names, pair.values(), strict=True)) for pair in row] for row in column.to_pylist()]
    return pa.array(rows, kind)


def _described(*path: Any, value: Any) -> Craft:
    def change(table: Any) -> Any:
        data = json.loads(table.schema.metadata[b"mimoc"])
        _set(data, path, value)
        return table.replace_schema_metadata({b"mimoc": json.dumps(data).encode()})

    return _table(change)


def _json(name: str, *path: Any, value: Any) -> Craft:
    def craft(folder: Path, outside: Path) -> None:
        data = json.loads((folder / name).read_bytes())
        _set(data, path, value)
        (folder / name).write_text(json.dumps(data))

    return craft


def _set(data: Any, path: tuple[Any, ...], value: Any) -> None:
    *way, last = path
    for key in way:
        data = data[key]
    data[last] = value


def _sidecar(*path: Any, value: Any) -> Craft:
    return _json(f"{WHOLE}.json", *path, value=value)


def _about(*path: Any, value: Any) -> Craft:
    return _json("recording.json", *path, value=value)


def _touched(change: Callable[[list[Any]], Any], path: str = f"{WHOLE}.parquet") -> Craft:
    def changed(rows: list[Any]) -> list[Any]:
        number = next(number for number, row in enumerate(rows) if len(row) > 1)
        return [change(row) if each == number else row for each, row in enumerate(rows)]

    return _values(TOUCH, changed, path)


def _copied(old: str, new: str) -> Craft:
    def craft(folder: Path, outside: Path) -> None:
        (folder / new).write_bytes((folder / old).read_bytes())

    return craft


def _streamed(folder: Path, outside: Path) -> None:
    path = folder / f"{PART}.parquet"
    table = pq.read_table(path)
    with pa.ipc.new_stream(path, table.schema) as writer:
        writer.write_table(table)


def _deep(folder: Path, outside: Path) -> None:
    (folder / "recording.json").write_text("[" * 10**6)


DIGEST = "sha256:" + 64 * "0"
STEP = "the column 'step' does not count the control steps from 0"
TABLES: dict[str, tuple[Craft, str]] = {
    "no steps": (_table(lambda table: table.drop_columns("step")), "the column 'step' is missing"),
    "no touch": (_table(lambda table: table.drop_columns(TOUCH)), f"the column '{TOUCH}' is missing"),
    "a column of no meaning": (
        _table(lambda table: table.append_column("x", table.column("reward"))),
        "the column 'x' is not one that mimoc writes",
    ),
    "an observation that is not described": (
        _table(lambda table: table.append_column("observation.x", table.column(ANGLES))),
        "the column 'observation.x' is not one that mimoc writes",
    ),
    "an info of text": (
        _table(lambda table: table.append_column(pa.field("info.x", pa.string(), False), [["x"] * len(table)])),
        "the column 'info.x' is of type 'string', not double",
    ),
    "a name to confuse a terminal": (
        _table(lambda table: table.append_column("\x1b[2J\n", table.column("reward"))),
        r"the column '\x1b[2J\n' is not one",
    ),
    "two columns of one name": (
        _table(lambda table: table.append_column("reward", table.column("reward"))),
        "it has two columns of one name",
    ),
    "steps as floats": (_column("step", lambda column: column.cast(pa.float64())), "'step' is of type 'double'"),
    "steps as text": (_column("step", lambda column: column.cast(pa.string())), "'step' is of type 'string'"),
    "rewards in single precision": (_column("reward", lambda column: column.cast(pa.float32())), "of type 'float'"),
    "rewards in a structure": (
        _column("reward", lambda column: pa.StructArray.from_arrays([column], ["x"])),
        "'reward' is of type 'struct<x: double>'",
    ),
    "rewards that may be null": (
        _column("reward", lambda column: column, nullable=True),
        "'reward' is of type 'double or null', not double",
    ),
    "rewards that are null": (
        _column("reward", lambda column: pa.nulls(len(column), column.type), nullable=True),
        "'reward' is of type 'double or null'",
    ),
    "flags as numbers": (
        _column("terminated", lambda column: column.cast(pa.int8())),
        "'terminated' is of type 'int8'",
    ),
    "actions in lists of any length": (
        _column("action", lambda column: pa.array(column.to_pylist(), pa.list_(column.type.value_field))),
        "'action' is of type 'list<element: double not null>'",
    ),
    "actions of fewer actuators": (_column("action", lambda column: _lists(column, 3)), "'action' is of type"),
    "angles of fewer joints": (_column(ANGLES, lambda column: _lists(column, 3)), f"'{ANGLES}' is of type"),
    "touch in whole numbers": (
        _column(TOUCH, lambda column: _pairs(column, pa.float64(), "index", "value")),
        f"'{TOUCH}' is of type",
    ),
    "touch by other names": (
        _column(TOUCH, lambda column: _pairs(column, pa.float32(), "number", "value")),
        f"'{TOUCH}' is of type",
    ),
    "touch in lists of numbers": (
        _column(TOUCH, lambda column: pa.array([[1.0]] * len(column), pa.list_(pa.float32()))),
        f"'{TOUCH}' is of type",
    ),
    "steps from 5": (_values("step", lambda rows: [row + 5 for row in rows]), STEP),
    "steps before the first": (_values("step", lambda rows: [-1, *rows[1:]]), STEP),
    "steps out of order": (_table(lambda table: table.take([0, 2, 1, 3, 4])), STEP),
    "an action that is no number": (
        _values("action", lambda rows: [*rows[:2], [np.nan] * len(rows[2]), *rows[3:]]),
        "'action' has numbers that are not finite",
    ),
    "touch before the first skin point": (_touched(lambda row: [{**row[0], "index": -1}]), "has an index that there"),
    "touch beyond the last skin point": (_touched(lambda row: [{**row[0], "index": 2**30}]), "has an index that there"),
    "touch of a skin point twice": (_touched(lambda row: [row[0], row[0]]), "an index that there is not, or one twice"),
    "fewer rows": (_table(lambda table: table.slice(0, 3)), "it has 3 rows of 5"),
    "no rows": (_table(lambda table: table.slice(0, 0)), "it has 0 rows of 5"),
    "more rows": (_table(lambda table: pa.concat_tables([table, table])), STEP),
    "a part of whole numbers": (
        _column("reward", lambda column: column.cast(pa.int64(), safe=False), f"{PART}.parquet"),
        "'reward' is of type 'int64', not double",
    ),
    "a part with touch beyond the last skin point": (
        _touched(lambda row: [{**row[0], "index": 2**30}], f"{PART}.parquet"),
        "has an index that there is not",
    ),
    "a part twice": (_copied("episodes/0000-000002.parquet", f"{PART}.parquet"), "control steps from 2"),
    "a part of another episode": (_copied(f"{WHOLE}.parquet", f"{PART}.parquet"), "control steps from 2"),
    "a part of Arrow": (_streamed, "the file is damaged"),
}
"""Well-formed tables that are not what the recording says, and what the error says of them."""
DESCRIPTIONS: dict[str, tuple[Craft, str]] = {
    "a table that says nothing": (_table(lambda table: table.replace_schema_metadata(None)), "Invalid JSON"),
    "a table of another version": (_described("recording", value=2), "recording: Input should be 1"),
    "a control step of 1e-300 ms": (_described("step_ms", value=1e-300), "step_ms: Input should be greater"),
    "no actuators": (_described("columns", "action", "layout", value=[]), "'action' is not one that mimoc writes"),
    "another shape": (_described("columns", ANGLES, "shape", value=[3]), "names for 3 numbers"),
    "a shape of half a number": (_described("columns", ANGLES, "shape", value=[1.5]), "shape.0: Input should be"),
    "a shape of -1": (_described("columns", ANGLES, "shape", value=[-1]), "shape.0: Input should be greater"),
    "a shape of 10^12": (_described("columns", TOUCH, "shape", value=[10**6, 10**6]), "more numbers than any infant"),
    "a type of objects": (_described("columns", ANGLES, "dtype", value="object"), "dtype: Input should be"),
    "touch as pictures": (_described("columns", TOUCH, "kind", value="picture"), "it is not that of a picture"),
    "10^12 names": (
        _described("columns", ANGLES, "layout", value=[{"name": "x", "from": 0, "to": 10**12, "ends": [""]}]),
        "more numbers than any infant has",
    ),
    "an observation elsewhere": (
        _described(
            "columns", "observation.../../x", value={"kind": "dense", "shape": [], "dtype": "bool", "layout": []}
        ),
        "it is not the name of an observation",
    ),
    "rows as text": (_sidecar("rows", value="5"), "rows: Input should be a valid integer"),
    "no rows said": (_sidecar("rows", value=0), "rows: Input should be greater"),
    "an episode of another infant": (_sidecar("infant", value=3), "this is an episode of another infant or recording"),
    "an episode of another recording": (_sidecar("bundle", value=DIGEST), "another infant or recording"),
    "a seed below 0": (_sidecar("reset", "seed", value=-1), "reset.seed: Input should be greater"),
    "a seed of a half": (_sidecar("reset", "seed", value=0.5), "reset.seed: Input should be a valid integer"),
    "options that are none": (_sidecar("reset", "options", value=[1]), "reset.options: Input should be"),
    "versions that are numbers": (_sidecar("versions", "mimoc", value=1), "versions.mimoc: Input should be"),
    "a change that nobody knows": (
        _sidecar("changes", value=[{"step": 1, "run": "rm -rf"}]),
        "changes.0.run: Extra inputs are not permitted",
    ),
    "two changes in one": (
        _sidecar("changes", value=[{"step": 1, "expression": "happy", "age_months": 9}]),
        "changes.0: it must be one change, not 2",
    ),
    "a change after the end": (
        _sidecar("changes", value=[{"step": 99, "expression": "happy"}]),
        "changes: there is no control step 99",
    ),
    "a state before the beginning": (_sidecar("states", 0, "step", value=-1), "states.0.step: Input should be greater"),
    "a key that nobody knows": (_sidecar("x", value=1), "x: Extra inputs are not permitted"),
    "a state of another type": (
        _sidecar("start", "steps", value={"$array": "AA", "dtype": "O", "shape": [1]}),
        "json: a state is damaged",
    ),
    "no infants": (_about("infants", value=[]), "marks: each must have a number for each of the 0 infants"),
    "a mark of other infants": (
        _about("marks", value=[{"run": "x", "steps": 0, "episodes": [1, 1]}]),
        "marks: each must have a number for each of the 1 infants",
    ),
    "a mark before the first episode": (
        _about("marks", value=[{"run": "x", "steps": 0, "episodes": [-1]}]),
        "marks.0.episodes.0: Input should be greater",
    ),
    "a recording of another version": (_about("recording", value=2), "reads recordings of version 1 only"),
    "a digest that is a path": (
        _about("infants", 0, "bundle", value="sha256:../../x"),
        "infants.0.bundle: String should match",
    ),
    "deep lists": (_deep, "Invalid JSON"),
    "an infant that there is not": (_copied(f"{WHOLE}.json", "episodes/0003-000000.json"), "there is no infant 3"),
}
"""JSON that is not what mimoc writes, and what the error says of it."""


def _encoded(codec: str, frames: int, side: int = 16, container: str = "matroska", part: str = WHOLE) -> Craft:
    def craft(folder: Path, outside: Path) -> None:
        av, path = require_av(), folder / f"{part}.eye_left.mkv"
        with av.open(str(path), "w", format=container) as video:
            stream = video.add_stream(codec, rate=50)
            stream.height = stream.width = side
            stream.pix_fmt = stream.codec.video_formats[0].name
            picture = np.zeros((side, side, 3), np.uint8)
            for _ in range(frames):
                video.mux(stream.encode(av.VideoFrame.from_ndarray(picture, "rgb24")))
            video.mux(stream.encode())

    return craft


def _grown(folder: Path, outside: Path) -> None:
    os.truncate(folder / f"{WHOLE}.eye_left.mkv", 2**36)


VIDEOS: dict[str, tuple[Craft, str]] = {
    "pictures by another codec": (_encoded("mpeg4", 5), "its pictures are not encoded by ffv1"),
    "pictures of another size": (_encoded("ffv1", 5, side=64), "of another size than 16 x 16 pixels"),
    "pictures of another container": (_encoded("mpeg4", 5, container="mp4"), "the file is damaged"),
    "fewer pictures than steps": (_encoded("ffv1", 3), "there are 3 pictures up to its end, where 5 were recorded"),
    "fewer pictures in a part": (_encoded("ffv1", 1, part=PART), "there are 3 pictures up to its end, where 4 were"),
    "64 GB of nothing": (_grown, "is larger than those of any infant"),
}
"""Videos that are not what the recording says, and what the error says of them."""

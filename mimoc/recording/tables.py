"""Rows of a recording as Parquet, with the names and units of all numbers in its schema."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.bundle import files
from mimoc.errors import MissingExtraError, RecordingError
from mimoc.recording.blocks import Array, Block, Reading
from mimoc.recording.layouts import shortened, written_out

try:
    import pyarrow as pa
    import pyarrow.parquet as pq
except ImportError:
    raise MissingExtraError("pyarrow", "record") from None

KEY = b"mimoc"
"""Key of what mimoc says of the columns in the schema's metadata."""
OBSERVATION = "observation."
"""What the names of the columns of observations begin with."""
SPLIT = ("float", "double")
"""Types whose bytes are compressed apart: floats of one quantity share signs and exponents."""


@dataclass(frozen=True, slots=True)
class Described:
    """What the schema of a recording says of its columns."""

    readings: tuple[Reading, ...]
    """The arrays of an observation."""
    actions: tuple[str, ...]
    """Actuators, in the order of an action."""
    step_ms: float
    """Duration of a control step."""

    def to_json(self) -> bytes:
        """Return it as it stands in the metadata."""
        found = {
            OBSERVATION + each.name: {
                "kind": each.kind,
                "shape": list(each.shape),
                "dtype": each.dtype,
                "layout": shortened(each.layout),
            }
            for each in self.readings
        }
        columns = {"action": {"layout": shortened(self.actions)}, **found}
        return json.dumps({"recording": 1, "step_ms": self.step_ms, "columns": columns}, ensure_ascii=False).encode()

    @classmethod
    def from_json(cls, text: bytes) -> "Described":
        """Return what metadata says."""
        told = json.loads(text)
        columns: Mapping[str, Any] = told["columns"]
        readings = tuple(
            Reading(
                name.removeprefix(OBSERVATION),
                tuple(each["shape"]),
                each["dtype"],
                each["kind"],
                written_out(each["layout"]),
            )
            for name, each in columns.items()
            if name.startswith(OBSERVATION)
        )
        return cls(readings, written_out(columns["action"]["layout"]), told["step_ms"])


def write_block(path: Path, block: Block, described: Described, *, quickly: bool = False) -> None:
    """Write the rows of a block, but for pictures.

    Args:
        path: The file.
        block: The rows.
        described: What their numbers are.
        quickly: Whether the file is soon to be joined with others, so that little work goes into making it small.

    Raises:
        OutputError: If the file cannot be written.
    """
    _write(path, [_table(block, described)], quickly=quickly)


def join(path: Path, parts: Sequence[Path]) -> None:
    """Write the rows of some files into one, with a row group for each.

    Raises:
        OutputError: If the file cannot be written.
        RecordingError: If a part is damaged.
    """
    schema = pa.unify_schemas([read_schema(part) for part in parts])
    _write(path, (_aligned(_read(part), schema) for part in parts), schema)


def read_schema(path: Path) -> Any:
    """Return the schema of a file.

    Raises:
        RecordingError: If it is damaged.
    """
    with _damage(path):
        return pq.read_schema(path)


def describe(path: Path) -> Described:
    """Return what the schema of a file says.

    Raises:
        RecordingError: If it is damaged, or not a recording's.
    """
    with _damage(path):
        return Described.from_json(read_schema(path).metadata[KEY])


def read_columns(paths: Sequence[Path]) -> Any:
    """Return the rows of some files as one Arrow table.

    Raises:
        RecordingError: If a file is damaged.
    """
    schema = pa.unify_schemas([read_schema(path) for path in paths])
    return pa.concat_tables([_aligned(_read(path), schema) for path in paths])


def array_of(table: Any, name: str, reading: Reading | None = None) -> Array:
    """Return a column as an array; of an observation with the shape that it had, shape (rows, ...)."""
    column = table.column(name).combine_chunks()
    if pa.types.is_fixed_size_list(column.type):
        flat = column.flatten().to_numpy(zero_copy_only=False)
        return flat.reshape(len(column), *(reading.shape if reading else (column.type.list_size,)))
    if reading is None:
        return column.to_numpy(zero_copy_only=False)
    dense = np.zeros((len(column), reading.size), reading.dtype)
    rows, index, value = sparse_of(table, name)
    dense[rows, index] = value
    return dense.reshape(len(column), *reading.shape)


def sparse_of(table: Any, name: str) -> tuple[Array, Array, Array]:
    """Return row, index and value of all numbers of a sparse column that are not zero."""
    column = table.column(name).combine_chunks()
    rows = np.repeat(np.arange(len(column)), np.diff(column.offsets.to_numpy()))
    found = column.flatten()
    return rows, found.field("index").to_numpy(), found.field("value").to_numpy(zero_copy_only=False)


def _table(block: Block, described: Described) -> Any:
    rows = block.rows
    columns: dict[str, Any] = {"step": pa.array(np.arange(block.first_step, block.first_step + rows, dtype=np.int32))}
    columns["action"] = _fixed(block.action[:rows])
    columns |= {name: pa.array(array[:rows]) for name, array in block.numbers.items()}
    for each in block.readings:
        name = OBSERVATION + each.name
        if each.kind == "dense":
            columns[name] = _fixed(block.dense[each.name][:rows])
        elif each.kind == "sparse":
            kept = block.sparse[each.name]
            end = kept.ends[rows]
            pairs = pa.StructArray.from_arrays(
                [pa.array(kept.index[:end]), pa.array(kept.value[:end])], ["index", "value"]
            )
            columns[name] = pa.ListArray.from_arrays(pa.array(kept.ends[: rows + 1]), pairs)
    return pa.table(columns).replace_schema_metadata({KEY: described.to_json()})


def _fixed(array: Array) -> Any:
    """Return an array of rows as lists of one length."""
    flat = pa.array(array.reshape(-1))
    return pa.FixedSizeListArray.from_arrays(flat, max(flat_size(array), 1)) if flat_size(array) else _empty(array)


def flat_size(array: Array) -> int:
    """Return how many numbers a row has."""
    return int(np.prod(array.shape[1:]))


def _empty(array: Array) -> Any:
    """Return rows without numbers."""
    return pa.array([[]] * len(array), pa.list_(pa.from_numpy_dtype(array.dtype), 0))


def _aligned(table: Any, schema: Any) -> Any:
    """Return a table with all columns of a schema; what it has not is NaN or False."""
    missing = {
        field.name: pa.array(np.full(len(table), np.nan) if pa.types.is_floating(field.type) else [False] * len(table))
        for field in schema
        if field.name not in table.column_names
    }
    columns = [missing[name] if name in missing else table.column(name) for name in schema.names]
    return pa.table(columns, schema=schema)


def _write(path: Path, tables: Sequence[Any] | Iterator[Any], schema: Any = None, *, quickly: bool = False) -> None:
    temporary = files.temporary_path(path)
    writer = None
    try:
        for table in tables:
            writer = writer or pq.ParquetWriter(
                temporary, schema or table.schema, write_statistics=False, **_encoding(table.schema, quickly)
            )
            writer.write_table(table, row_group_size=len(table))
        assert writer is not None
        writer.close()
    except OSError as error:
        files.discard(temporary)
        raise files.write_error(path, error) from None
    files.move_into_place(temporary, path)


def _encoding(schema: Any, quickly: bool) -> dict[str, Any]:
    """Return how the columns of a schema are encoded and compressed."""
    if quickly:
        return {"use_dictionary": False, "compression": "lz4"}
    leaves = [leaf for field in schema for leaf in _leaves(field.name, field.type)]
    split = {path: "BYTE_STREAM_SPLIT" for path, kind in leaves if str(kind) in SPLIT}
    return {"use_dictionary": False, "column_encoding": split, "compression": "zstd", "compression_level": 1}


def _leaves(path: str, kind: Any) -> Iterator[tuple[str, Any]]:
    """Yield the path of each column in a file of Parquet, with its type."""
    if pa.types.is_struct(kind):
        for field in kind:
            yield from _leaves(f"{path}.{field.name}", field.type)
    elif pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind):
        yield from _leaves(f"{path}.list.element", kind.value_type)
    else:
        yield path, kind


def _read(path: Path) -> Any:
    with _damage(path):
        return pq.read_table(path)


class _damage:  # noqa: N801 - A context manager.
    """Turns what PyArrow says of a damaged file into one clear line."""

    def __init__(self, path: Path):
        self._path = path

    def __enter__(self) -> None:
        return

    def __exit__(self, kind: Any, error: BaseException | None, trace: Any) -> None:
        if isinstance(error, (pa.ArrowException, OSError, ValueError, KeyError, TypeError)):
            raise RecordingError(f"{self._path}: the file is damaged or missing") from None

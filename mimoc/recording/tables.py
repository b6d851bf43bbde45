"""Rows of a recording as Parquet, with the names and units of all numbers in its schema."""

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.bundle import files
from mimoc.errors import MissingExtraError, RecordingError
from mimoc.recording.blocks import Array, Block, Reading, Sparse
from mimoc.recording.folder import WHOLE
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
KINDS, DTYPES = ("dense", "sparse", "picture"), ("float32", "float64", "uint8", "int8", "int32", "int64", "bool")
"""What there is of arrays in observations."""
MOST_NUMBERS = 2**26
"""Of one array of an observation; pictures have the most."""
MOST_STEP_MS = 1e6
SMALL_BYTES, MOST_RATIO = 2**29, 100
"""What a file may hold however small it is, and how many times its size."""
LEVEL = -4
"""Of zstd: a third faster than 1, for files that are a tenth larger."""
SPLIT = ("float", "double")
"""Types whose bytes are compressed apart: floats of one quantity share signs and exponents."""


@dataclass(frozen=True)
class Described:
    """What the schema of a recording says of its columns."""

    readings: tuple[Reading, ...]
    """The arrays of an observation."""
    actions: tuple[str, ...]
    """Actuators, in the order of an action."""
    step_ms: float
    """Duration of a control step."""

    @cached_property
    def json(self) -> bytes:
        """It as it stands in the metadata."""
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
        if not all(map(_is_reading, readings)) or not 0 < told["step_ms"] <= MOST_STEP_MS:
            raise ValueError("the description of another program")
        return cls(readings, written_out(columns["action"]["layout"]), told["step_ms"])


def _is_reading(reading: Reading) -> bool:
    """Return whether an array of an observation is one that an infant can have."""
    sizes = reading.shape
    if not all(type(size) is int and 0 <= size <= MOST_NUMBERS for size in sizes) or math.prod(sizes) > MOST_NUMBERS:
        return False
    if reading.kind == "picture" and not (reading.dtype == "uint8" and len(sizes) == 3 and sizes[2] == 3):
        return False
    is_named = reading.name.isprintable() and "/" not in reading.name and len(reading.name) < 200
    return is_named and reading.kind in KINDS and reading.dtype in DTYPES and len(reading.layout) in (0, reading.size)


def write_block(path: Path, block: Block, described: Described) -> None:
    """Write the rows of a block, but for pictures, as an Arrow stream, which takes hardly any time.

    Raises:
        OutputError: If the file cannot be written.
    """
    temporary, table = files.temporary_path(path), _table(block, described)
    try:
        with pa.OSFile(str(temporary), "wb") as sink, pa.ipc.new_stream(sink, table.schema) as writer:
            writer.write_table(table)
    except OSError as error:
        files.discard(temporary)
        raise files.write_error(path, error) from None
    files.move_into_place(temporary, path)


def join(path: Path, parts: Sequence[Path]) -> None:
    """Write the rows of some parts as one file of Parquet, with a row group for each.

    Raises:
        OutputError: If the file cannot be written.
        RecordingError: If a part is damaged.
    """
    schema, temporary = _schema_of(parts), files.temporary_path(path)
    try:
        with pq.ParquetWriter(temporary, schema, write_statistics=False, **_encoding(schema)) as writer:
            for part in parts:
                table = _aligned(_read(part), schema)
                writer.write_table(table, row_group_size=len(table))
    except RecordingError:
        files.discard(temporary)
        raise
    except OSError as error:
        files.discard(temporary)
        raise files.write_error(path, error) from None
    files.move_into_place(temporary, path)


def describe(path: Path) -> Described:
    """Return what the schema of a file says.

    Raises:
        RecordingError: If it is damaged, or not a recording's.
    """
    with damage_told(path), _opened(path) as reader:
        return Described.from_json(_schema(reader).metadata[KEY])


def read_columns(paths: Sequence[Path]) -> Any:
    """Return the rows of some files as one Arrow table.

    Raises:
        RecordingError: If a file is damaged.
    """
    schema = _schema_of(paths)
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
        if each.kind == "dense":
            columns[OBSERVATION + each.name] = _fixed(block.dense[each.name][:rows])
        elif each.kind == "sparse":
            columns[OBSERVATION + each.name] = _listed(block.sparse[each.name], rows)
    fields = [pa.field(name, column.type, nullable=False) for name, column in columns.items()]
    return pa.table([*columns.values()], schema=pa.schema(fields, {KEY: described.json}))


def _listed(kept: Sparse, rows: int) -> Any:
    """Return rows of index and value of the numbers that are not zero."""
    end = kept.ends[rows]
    parts = {"index": pa.array(kept.index[:end]), "value": pa.array(kept.value[:end])}
    fields = [pa.field(name, part.type, nullable=False) for name, part in parts.items()]
    pairs = pa.StructArray.from_arrays([*parts.values()], fields=fields)
    kind = pa.list_(pa.field("element", pairs.type, nullable=False))
    return pa.ListArray.from_arrays(pa.array(kept.ends[: rows + 1]), pairs, type=kind)


def _fixed(array: Array) -> Any:
    """Return an array of rows as lists of one length."""
    kind = pa.list_(pa.field("element", pa.from_numpy_dtype(array.dtype), nullable=False), flat_size(array))
    if not flat_size(array):
        return pa.array([[]] * len(array), kind)
    return pa.FixedSizeListArray.from_arrays(pa.array(array.reshape(-1)), type=kind)


def flat_size(array: Array) -> int:
    """Return how many numbers a row has."""
    return int(np.prod(array.shape[1:]))


def _aligned(table: Any, schema: Any) -> Any:
    """Return a table with all columns of a schema; what it has not is NaN or False."""
    missing = {
        field.name: pa.array(np.full(len(table), np.nan) if pa.types.is_floating(field.type) else [False] * len(table))
        for field in schema
        if field.name not in table.column_names
    }
    columns = [missing[name] if name in missing else table.column(name) for name in schema.names]
    return pa.table(columns, schema=schema)


def _encoding(schema: Any) -> dict[str, Any]:
    """Return how the columns of a schema are encoded and compressed."""
    leaves = [leaf for field in schema for leaf in _leaves(field.name, field.type)]
    split = {path: "BYTE_STREAM_SPLIT" for path, kind in leaves if str(kind) in SPLIT}
    return {"use_dictionary": False, "column_encoding": split, "compression": "zstd", "compression_level": LEVEL}


def _leaves(path: str, kind: Any) -> Iterator[tuple[str, Any]]:
    """Yield the path of each column in a file of Parquet, with its type."""
    if pa.types.is_struct(kind):
        for field in kind:
            yield from _leaves(f"{path}.{field.name}", field.type)
    elif pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind):
        yield from _leaves(f"{path}.list.element", kind.value_type)
    else:
        yield path, kind


def _schema_of(paths: Sequence[Path]) -> Any:
    """Return a schema with the columns of all files."""
    schemas = []
    for path in paths:
        with damage_told(path), _opened(path) as reader:
            schemas.append(_schema(reader))
    return pa.unify_schemas(schemas)


def _opened(path: Path) -> Any:
    return pq.ParquetFile(path) if path.suffix == WHOLE else pa.ipc.open_stream(str(path))


def _schema(reader: Any) -> Any:
    return reader.schema_arrow if isinstance(reader, pq.ParquetFile) else reader.schema


def _read(path: Path) -> Any:
    with damage_told(path):
        if path.suffix == WHOLE:
            _check_size(path)
            return pq.read_table(path)
        _check_unpacked(path)
        with pa.OSFile(str(path), "rb") as source, pa.ipc.open_stream(source) as reader:
            return reader.read_all()


def _check_size(path: Path) -> None:
    """Check that a file is not far smaller than what is read from it: numbers that change cannot be packed so well."""
    about = pq.read_metadata(path)
    groups = [about.row_group(index) for index in range(about.num_row_groups)]
    numbers = sum(group.column(index).num_values for group in groups for index in range(group.num_columns))
    if 8 * numbers > max(SMALL_BYTES, MOST_RATIO * path.stat().st_size):
        raise ValueError("it would unpack to more than it can hold")


def _check_unpacked(path: Path) -> None:
    """Check that a part is as mimoc writes it: nothing in it is packed, so that it unpacks to no more than it has."""
    with pa.OSFile(str(path), "rb") as source:
        for message in pa.ipc.MessageReader.open_stream(source):
            is_rows = message.type == "record batch"
            if not (is_rows or message.type == "schema") or (is_rows and _is_packed(message.metadata.to_pybytes())):
                raise ValueError("it is packed")


def _is_packed(message: bytes) -> bool:
    """Return whether the rows of an Arrow message are compressed.

    Its metadata is a FlatBuffer: the field `compression`, the fourth of the table `RecordBatch`, is there or not, and
    this table is the third field of the table `Message`, as Arrow's `format/Message.fbs` says.
    """

    def number(at: int, size: int) -> int:
        return int.from_bytes(message[at : at + size], "little")

    def field(table: int, index: int) -> int:
        """Return where a field of a table is, 0 if it is left out."""
        listed = table - int.from_bytes(message[table : table + 4], "little", signed=True)
        at = number(listed + 4 + 2 * index, 2) if 4 + 2 * index < number(listed, 2) else 0
        return table + at if at else 0

    header = field(number(0, 4), 2)
    return bool(field(header + number(header, 4), 3))


DAMAGED = (
    *(pa.ArrowException, OSError, RecursionError),
    *(ValueError, LookupError, TypeError, AttributeError, OverflowError),
)
"""What is raised of files that are damaged."""


@contextmanager
def damage_told(path: Path) -> Iterator[None]:
    """Turn what PyArrow says of a damaged file into one clear line."""
    try:
        yield
    except DAMAGED:
        raise RecordingError(f"{path}: the file is damaged or missing") from None

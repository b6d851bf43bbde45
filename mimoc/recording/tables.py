"""Rows of a recording as Parquet, with the names and units of all numbers in its schema."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from mimoc.bundle import files
from mimoc.bundle.regular_files import UnusableFileError, open_regular_file
from mimoc.errors import RecordingError
from mimoc.quantities import QUANTITIES
from mimoc.recording.arrow import pa, pq
from mimoc.recording.blocks import Array, Block, Reading, Sparse
from mimoc.recording.described import ACTION, KEY, OBSERVATION, Described
from mimoc.recording.folder import WHOLE
from mimoc.recording.table_check import (
    MEASURE,
    STEP,
    check_rows,
    check_schema,
    has_numbers,
    lists_of,
    pairs_of,
    sparse_of,
)

SMALL_BYTES, MOST_RATIO = 2**29, 100
"""What a file may hold however small it is, and how many times its size."""
MOST_DENSE_RATIO = 2**10
"""The same of arrays with all the zeros that a sparse column leaves out."""
MOST_BYTES, MOST_PART_BYTES = 2**40, 2**30
"""Of a file, and of a part, of which all infants together have no more than `ROOM_BYTES` in memory."""
LEVEL = -4
"""Of zstd: a third faster than 1, for files that are a tenth larger."""
SPLIT = ("float", "double")
"""Types whose bytes are compressed apart: floats of one quantity share signs and exponents."""


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
    described, schema, temporary = describe(parts), _joined_schema(parts), files.temporary_path(path)
    first_step = 0
    try:
        with pq.ParquetWriter(temporary, schema, write_statistics=False, **_encoding(schema)) as writer:
            for part in parts:
                table = _aligned(_read(part, described, first_step), schema)
                if len(table):  # Parquet has no empty groups.
                    writer.write_table(table, row_group_size=len(table))
                first_step += len(table)
    except RecordingError:
        files.discard(temporary)
        raise
    except OSError as error:
        files.discard(temporary)
        raise files.write_error(path, error) from None
    files.move_into_place(temporary, path)


def describe(paths: Sequence[Path]) -> Described:
    """Return what the schemas of some files of one episode say, which all say the same.

    Raises:
        RecordingError: If one is damaged, not a recording's, or has other columns than it says.
    """
    described: Described | None = None
    for path in paths:
        with _opened(path) as reader:
            current = _described(reader)
            if described not in (None, current):
                raise UnusableFileError("it describes other columns than the part before")
            described = current
    assert described is not None
    return described


def read_columns(paths: Sequence[Path], described: Described) -> Any:
    """Return the rows of some files of one episode as one Arrow table.

    Raises:
        RecordingError: If a file is damaged, or is not as described.
    """
    schema, tables = _joined_schema(paths), list[Any]()
    for path in paths:
        first_step = sum(map(len, tables))
        tables.append(_aligned(_read(path, described, first_step), schema))
    return pa.concat_tables(tables)


def array_of(table: Any, name: str, reading: Reading | None = None) -> Array:
    """Return a column as an array; of an observation with the shape that it had, shape (rows, ...).

    Lists without numbers have no column.
    """
    if name not in table.column_names and (reading or name == ACTION):
        return np.zeros((len(table), *(reading.shape if reading else (0,))), reading.dtype if reading else float)
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


def _table(block: Block, described: Described) -> Any:
    rows = block.rows
    columns: dict[str, Any] = {STEP: pa.array(np.arange(block.first_step, block.first_step + rows, dtype=np.int32))}
    columns[ACTION] = _fixed(block.action[:rows])
    columns |= {name: pa.array(array[:rows]) for name, array in block.numbers.items()}
    for each in block.readings:
        if each.kind == "dense":
            columns[OBSERVATION + each.name] = _fixed(block.dense[each.name][:rows])
        elif each.kind == "sparse":
            columns[OBSERVATION + each.name] = _listed(block.sparse[each.name], rows)
    columns = {name: column for name, column in columns.items() if has_numbers(column.type)}
    fields = [pa.field(name, column.type, False, _metadata(name)) for name, column in columns.items()]
    return pa.table([*columns.values()], schema=pa.schema(fields, {KEY: described.json}))


def _metadata(column: str) -> dict[str, str] | None:
    """Return what is written of a column besides its type: label and unit of a quantity."""
    quantity = QUANTITIES.get(column.removeprefix(MEASURE)) if column.startswith(MEASURE) else None
    return {"label": quantity.label, "unit": quantity.unit, "about": quantity.about} if quantity else None


def _listed(kept: Sparse, rows: int) -> Any:
    """Return rows of index and value of the numbers that are not zero."""
    end = kept.ends[rows]
    index, value = pa.array(kept.index[:end]), pa.array(kept.value[:end])
    kind = pairs_of(value.type)
    pairs = pa.StructArray.from_arrays([index, value], fields=list(kind.value_type))
    return pa.ListArray.from_arrays(pa.array(kept.ends[: rows + 1]), pairs, type=kind)


def _fixed(array: Array) -> Any:
    """Return an array of rows as lists of one length."""
    kind = lists_of(pa.from_numpy_dtype(array.dtype), flat_size(array))
    if not has_numbers(kind):
        return pa.array([[]] * len(array), kind)
    return pa.FixedSizeListArray.from_arrays(pa.array(array.reshape(-1)), type=kind)


def flat_size(array: Array) -> int:
    """Return how many numbers a row has."""
    return int(np.prod(array.shape[1:]))


def _joined_schema(paths: Sequence[Path]) -> Any:
    """Return a schema with the columns of all files; what is a flag in some and a number in others is a number."""
    metadata, joined = None, dict[str, Any]()
    for path in paths:
        with _opened(path) as reader:
            schema = _schema(reader)
        metadata = metadata or {KEY: schema.metadata[KEY]}
        for field in schema:
            known = joined.setdefault(field.name, field)
            joined[field.name] = known if known.type == field.type else known.with_type(pa.float64())
    return pa.schema([*joined.values()], metadata)


def _aligned(table: Any, schema: Any) -> Any:
    """Return a table with all columns of a schema; what it has not is NaN or False."""
    missing = {
        field.name: pa.array(np.full(len(table), np.nan) if pa.types.is_floating(field.type) else [False] * len(table))
        for field in schema
        if field.name not in table.column_names
    }
    columns = [
        missing[field.name] if field.name in missing else table.column(field.name).cast(field.type) for field in schema
    ]
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


@contextmanager
def _opened(path: Path, *, for_rows: bool = False) -> Iterator[Any]:
    """Open a file to read its schema, or its rows as well; whatever is wrong with it is one clear line."""
    is_whole = path.suffix == WHOLE
    try:
        file = open_regular_file(path, MOST_BYTES if is_whole else MOST_PART_BYTES, below=path.parents[1])
        if file is None:
            raise UnusableFileError("the file is missing")
        with file, pq.ParquetFile(file) if is_whole else _stream(file, for_rows) as reader:
            yield reader
    except UnusableFileError as error:
        raise RecordingError(f"{path}: {error}") from None
    except DAMAGED:
        raise RecordingError(f"{path}: the file is damaged") from None


def _stream(file: BinaryIO, for_rows: bool) -> Any:
    if not for_rows:
        return pa.ipc.open_stream(file)
    content = pa.py_buffer(file.read())
    _check_unpacked(content)
    return pa.ipc.open_stream(content)


def _schema(reader: Any) -> Any:
    return reader.schema_arrow if isinstance(reader, pq.ParquetFile) else reader.schema


def _described(reader: Any) -> Described:
    """Return what the schema of an open file says, which it must be itself."""
    schema = _schema(reader)
    described = Described.from_json((schema.metadata or {}).get(KEY, b""))
    check_schema(schema, described)
    return described


def _read(path: Path, described: Described, first_step: int) -> Any:
    """Return the rows of a file, of which the first has a number."""
    with _opened(path, for_rows=True) as reader:
        size = path.stat().st_size
        if _described(reader) != described:
            raise UnusableFileError("it describes other columns than the recording")
        if path.suffix == WHOLE:
            _check_packed(reader.metadata, size)
        table = reader.read() if path.suffix == WHOLE else reader.read_all()
        check_rows(table, described, first_step)
        dense = max((reading.size for reading in described.readings if reading.kind == "sparse"), default=0)
        if 8 * dense * len(table) > max(SMALL_BYTES, MOST_DENSE_RATIO * size):
            raise UnusableFileError("it would unpack to more than it can hold")
        return table


def _check_packed(about: Any, size: int) -> None:
    """Check that a file is not far smaller than what is read from it: numbers that change cannot be packed so well.

    Raises:
        UnusableFileError: If it is.
    """
    groups = [about.row_group(index) for index in range(about.num_row_groups)]
    numbers = sum(group.column(index).num_values for group in groups for index in range(group.num_columns))
    if 8 * numbers > max(SMALL_BYTES, MOST_RATIO * size):
        raise UnusableFileError("it would unpack to more than it can hold")


def _check_unpacked(content: Any) -> None:
    """Check that a part is as mimoc writes it: nothing in it is packed, so that it unpacks to no more than it has.

    Raises:
        UnusableFileError: If it is not.
    """
    for message in pa.ipc.MessageReader.open_stream(pa.BufferReader(content)):
        is_rows = message.type == "record batch"
        if not (is_rows or message.type == "schema") or (is_rows and _is_packed(message.metadata.to_pybytes())):
            raise UnusableFileError("it is packed, or has more than rows")


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
    *(pa.ArrowException, OSError, RecursionError, MemoryError),
    *(ValueError, LookupError, TypeError, AttributeError, OverflowError),
)
"""What PyArrow raises of files that are damaged."""

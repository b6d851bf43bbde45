"""Rows of a recording as Parquet: columns of exact types, which follow from its description, with checked values."""

import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.errors import MissingExtraError
from mimoc.base.quantities import QUANTITIES
from mimoc.bundle.files import write_file
from mimoc.bundle.regular_files import UnusableFileError
from mimoc.recording.columns import ACTION, KEY, MOVEMENT, MOVEMENT_NAMES, OBSERVATION, Array, Block, Described, Reading
from mimoc.recording.folder import opened

try:
    import pyarrow
    import pyarrow.parquet
except ImportError:
    raise MissingExtraError("pyarrow", "record") from None

pa: Any = pyarrow
pq: Any = pyarrow.parquet


STEP = "step"
NUMBERS = ("time_s", "reward")
FLAGS = ("terminated", "truncated")
MEASURE = "measure."  # What the names of columns of quantities begin with.
OPTIONAL = ("info.", "term.", MEASURE)
"""What the names of columns begin with that a table may have besides: numbers or flags."""
NAMES = pa.dictionary(pa.int32(), pa.string())
"""Type of the texts of movement columns, of which few rows differ: those of a row, separated by `BETWEEN`."""
BETWEEN = "\t"
MAX_NAMES = 100_000
"""Characters of the names of one row: fifty parts of a body that touch twenty things each have 20,000."""
_MAX_SHOWN = 60  # Most characters of a name or type in an error.


def check_schema(schema: Any, described: Described) -> None:
    """Check that a table has the columns of its description, of exactly their types, and else only optional ones."""
    names, wanted = schema.names, columns_of(described)
    if missing := [name for name in wanted if name not in names]:
        raise UnusableFileError(f"the column {_shown(missing[0])} is missing")
    if len(set(names)) < len(names):
        raise UnusableFileError("it has two columns of one name")
    for field in schema:
        optional = [pa.float64(), pa.bool_()] if field.name.startswith(OPTIONAL) else []
        kinds = [wanted[field.name]] if field.name in wanted else optional
        if not kinds:
            raise UnusableFileError(f"the column {_shown(field.name)} is not one that mimoc writes")
        if field.nullable or field.type not in kinds:
            given = f"{field.type}{' or null' if field.nullable else ''}"
            raise UnusableFileError(f"the column {_shown(field.name)} is of type {_shown(given)}, not {kinds[0]}")


def columns_of(described: Described) -> Mapping[str, Any]:
    """Return the Arrow type of each column that a table with a description has; none of them has nulls.

    Lists without numbers, such as the actions of an infant whose joints are all locked, have no column: with a type
    that admits no nulls, writing them ends Python with pyarrow 26.
    """
    columns = {STEP: pa.int32()}
    if described.actions:
        columns[ACTION] = _lists_of(pa.float64(), len(described.actions))
    columns |= dict.fromkeys(NUMBERS, pa.float64()) | dict.fromkeys(FLAGS, pa.bool_())
    for reading in described.readings:
        number = pa.from_numpy_dtype(np.dtype(reading.dtype))
        if reading.kind == "sparse":
            pair = [pa.field("index", pa.int32(), nullable=False), pa.field("value", number, nullable=False)]
            columns[OBSERVATION + reading.name] = _lists_of(pa.struct(pair))
        elif reading.kind == "dense" and reading.size:
            columns[OBSERVATION + reading.name] = _lists_of(number, reading.size)
    if described.movement:
        columns[MOVEMENT] = _lists_of(pa.float32(), len(described.movement))
    if described.movement_names:
        columns[MOVEMENT_NAMES] = NAMES
    return columns


def _lists_of(element: Any, size: int = -1) -> Any:
    return pa.list_(pa.field("element", element, nullable=False), size)


def check_rows(table: Any, described: Described, first_step: int) -> None:
    """Check the values of a table that has the columns of its description, whose first row is of some step."""
    table.validate(full=True)
    for name in table.column_names:
        if any(map(_has_nulls, table.column(name).chunks)):
            raise UnusableFileError(f"the column {_shown(name)} has nulls")
    if described.movement_names:
        for chunk in table.column(MOVEMENT_NAMES).chunks:
            if not all(_is_row_of_names(row, described) for row in chunk.dictionary.to_pylist()):
                raise UnusableFileError(f"the column '{MOVEMENT_NAMES}' has rows of other names than mimoc writes")
    if not np.array_equal(table.column(STEP).to_numpy(), np.arange(first_step, first_step + len(table))):
        raise UnusableFileError(f"the column '{STEP}' does not count the control steps from {first_step}")
    acted = table.select([ACTION] if ACTION in table.column_names else []).slice(1 if first_step == 0 else 0)
    if not all(np.isfinite(chunk.flatten().to_numpy()).all() for column in acted.columns for chunk in column.chunks):
        raise UnusableFileError(f"the column '{ACTION}' has numbers that are not finite")
    for reading in described.readings:
        if reading.kind == "sparse":
            rows, index, _ = sparse_of(table, OBSERVATION + reading.name)
            is_inside = (index >= 0).all() and (index < reading.size).all()
            if not is_inside or not ((np.diff(index) > 0) | (np.diff(rows) > 0)).all():
                name = OBSERVATION + reading.name
                raise UnusableFileError(f"the column '{name}' has an index that there is not, or one twice")


def _is_row_of_names(row: str, described: Described) -> bool:
    texts = row.split(BETWEEN)
    return len(row) <= MAX_NAMES and len(texts) == len(described.movement_names) and all(map(str.isprintable, texts))


def sparse_of(table: Any, name: str) -> tuple[Array, Array, Array]:
    """Return row, index and value of all numbers of a sparse column that are not zero."""
    column = table.column(name).combine_chunks()
    rows = np.repeat(np.arange(len(column)), np.diff(column.offsets.to_numpy()))
    pairs = column.flatten()
    return rows, pairs.field("index").to_numpy(), pairs.field("value").to_numpy(zero_copy_only=False)


def _has_nulls(array: Any) -> bool:
    if array.null_count:
        return True
    if pa.types.is_struct(array.type):
        return any(map(_has_nulls, array.flatten()))
    return pa.types.is_nested(array.type) and _has_nulls(array.flatten())


def _shown(text: object) -> str:
    """Return the beginning of a stranger's text in quotes, with what cannot be printed escaped."""
    return f"{str(text)[:_MAX_SHOWN]!r}"


SMALL_BYTES, MAX_RATIO = 2**29, 100  # What a file may hold however small it is, and how many times its size.
MAX_DENSE_RATIO = 2**10  # The same ratio for arrays with all the zeros that a sparse column leaves out.
MAX_BYTES = 2**40  # Largest size of a file.
LEVEL = -4  # Compression level of zstd: a third faster than 1, for files that are a tenth larger.
SPLIT = ("float", "double")  # Types whose bytes are compressed apart: floats of one quantity share signs and exponents.


def write_block(path: Path, block: Block, described: Described) -> None:
    """Write the rows of a block, but for pictures, or raise an OutputError."""
    rows, kinds = block.rows, columns_of(described)
    columns: dict[str, Any] = {STEP: pa.array(np.arange(block.first_step, block.first_step + rows, dtype=np.int32))}
    if ACTION in kinds:
        columns[ACTION] = _fixed(block.action[:rows], kinds[ACTION])
    columns |= {name: pa.array(array[:rows]) for name, array in block.numbers.items()}
    for reading in block.readings:
        name = OBSERVATION + reading.name
        if reading.kind == "sparse":
            kept = block.sparse[reading.name]
            kind = kinds[name]
            end, pair = kept.ends[rows], kind.value_type
            pairs = pa.StructArray.from_arrays(
                [pa.array(kept.index[:end]), pa.array(kept.value[:end])], fields=list(pair)
            )
            columns[name] = pa.ListArray.from_arrays(pa.array(kept.ends[: rows + 1]), pairs, type=kind)
        elif name in kinds:
            columns[name] = _fixed(block.dense[reading.name][:rows], kinds[name])
    columns |= _movement(block, kinds)
    fields = [pa.field(name, column.type, False, _metadata(name)) for name, column in columns.items()]
    write_table(path, pa.table([*columns.values()], schema=pa.schema(fields, {KEY: described.json})))


def _movement(block: Block, kinds: Mapping[str, Any]) -> dict[str, Any]:
    columns: dict[str, Any] = {}
    if block.movement:
        values = [samples.values() for samples in block.movement]
        if MOVEMENT in kinds:
            numbers = np.concatenate([item.numbers for item in values])
            columns[MOVEMENT] = _fixed(numbers.astype(np.float32), kinds[MOVEMENT])
        if MOVEMENT_NAMES in kinds:
            texts = [BETWEEN.join(row) for item in values for row in item.texts]
            columns[MOVEMENT_NAMES] = pa.array(texts, kinds[MOVEMENT_NAMES])
    return columns


def _metadata(column: str) -> dict[str, str] | None:
    quantity = QUANTITIES.get(column.removeprefix(MEASURE)) if column.startswith(MEASURE) else None
    return {"label": quantity.label, "unit": quantity.unit, "about": quantity.about} if quantity else None


def write_table(path: Path, table: Any) -> None:
    """Write a table as one file of Parquet, whole or not at all, or raise an OutputError."""
    leaves = [leaf for field in table.schema for leaf in _leaves(field.name, field.type)]
    split = {leaf: "BYTE_STREAM_SPLIT" for leaf, kind in leaves if str(kind) in SPLIT}
    names = [field.name for field in table.schema if field.type == NAMES]
    how: dict[str, Any] = {"use_dictionary": names, "write_statistics": False, "column_encoding": split}
    content = io.BytesIO()
    pq.write_table(table, content, compression="zstd", compression_level=LEVEL, **how)
    write_file(path, content.getvalue())


def describe(paths: Sequence[Path]) -> Described:
    """Return what the schemas of all parts of one episode say, or raise a RecordingError if one differs."""
    descriptions = list[Described]()
    for path in paths:
        with _opened(path) as file:
            descriptions.append(described_by(file.schema_arrow))
            if descriptions[-1] != descriptions[0]:
                raise UnusableFileError("it describes other columns than the part before")
    return descriptions[0]


def described_by(schema: Any) -> Described:
    """Return what the schema of a file says of its columns, or raise an UnusableFileError if it has other ones."""
    described = Described.from_json((schema.metadata or {}).get(KEY, b""))
    check_schema(schema, described)
    return described


def read_columns(paths: Sequence[Path], described: Described) -> Any:
    """Return the rows of all parts of one episode as one Arrow table.

    What is a flag in one part and a number in another is a number; a column that a part lacks is NaN or False there.
    """
    parts, fields = list[Any](), dict[str, Any]()
    for path in paths:
        part = _read(path, described, first_step=sum(map(len, parts)))
        parts.append(part)
        for field in part.schema:
            known = fields.setdefault(field.name, field)
            fields[field.name] = known if known.type == field.type else known.with_type(pa.float64())
    schema = pa.schema([*fields.values()], parts[0].schema.metadata)
    return pa.concat_tables([_aligned(part, schema) for part in parts])


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


def movement_of(table: Any, described: Described) -> dict[str, Array]:
    """Return all movement columns by name, each of shape (rows,); those of texts have objects."""
    numbers = array_of(table, MOVEMENT) if described.movement else np.empty((0, 0))
    columns = dict(zip(described.movement, numbers.T, strict=False))
    if described.movement_names:
        rows = [row.split(BETWEEN) for row in table.column(MOVEMENT_NAMES).to_pylist()]
        columns |= {
            name: np.array([row[index] for row in rows], object) for index, name in enumerate(described.movement_names)
        }
    return columns


def _fixed(array: Array, kind: Any) -> Any:
    return pa.FixedSizeListArray.from_arrays(pa.array(array.reshape(-1)), type=kind)


def _aligned(table: Any, schema: Any) -> Any:

    def column(field: Any) -> Any:
        if field.name in table.column_names:
            return table.column(field.name).cast(field.type)
        return pa.array(np.full(len(table), np.nan if pa.types.is_floating(field.type) else False))

    return pa.table([column(field) for field in schema], schema=schema)


def _leaves(path: str, kind: Any) -> Iterator[tuple[str, Any]]:
    if pa.types.is_struct(kind):
        for field in kind:
            yield from _leaves(f"{path}.{field.name}", field.type)
    elif pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind):
        yield from _leaves(f"{path}.list.element", kind.value_type)
    else:
        yield path, kind


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    with opened(path, MAX_BYTES, *DAMAGED) as file, pq.ParquetFile(file) as parquet:
        yield parquet


def _read(path: Path, described: Described, first_step: int) -> Any:
    with _opened(path) as file:
        size = path.stat().st_size
        if described_by(file.schema_arrow) != described:
            raise UnusableFileError("it describes other columns than the recording")
        groups = [file.metadata.row_group(index) for index in range(file.metadata.num_row_groups)]
        packed = [group.column(index) for group in groups for index in range(group.num_columns)]
        numbers = sum(max(column.num_values, column.total_uncompressed_size // 8) for column in packed)
        _check_packed(numbers, MAX_RATIO * size)
        table = file.read(use_threads=False)  # Threads of PyArrow can outlive Python, which ends in an abort.
        check_rows(table, described, first_step)
        dense = max((reading.size for reading in described.readings if reading.kind == "sparse"), default=0)
        _check_packed(dense * len(table), MAX_DENSE_RATIO * size)
        return table


def _check_packed(numbers: int, most_bytes: int) -> None:
    """Check that a file is not far smaller than what is read from it: numbers that change cannot be packed so well."""
    if 8 * numbers > max(SMALL_BYTES, most_bytes):
        raise UnusableFileError("it would unpack to more than it can hold")


DAMAGED = (
    *(pa.ArrowException, OSError, RecursionError, MemoryError),
    *(ValueError, LookupError, TypeError, AttributeError, OverflowError),
)
"""What PyArrow raises of files that are damaged."""

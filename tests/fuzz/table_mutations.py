"""Changes by chance to well-formed tables: names, types, nulls, lengths, values, metadata and how they are written."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.compute as pc
import pyarrow.parquet as pq
from fuzz.mutations import Generator, changed_data, pick

NUMBERS = (pa.int8(), pa.uint8(), pa.int32(), pa.int64(), pa.uint64(), pa.float16(), pa.float32(), pa.float64())
KINDS = (*NUMBERS, pa.bool_(), pa.string(), pa.binary(), pa.null(), pa.timestamp("ns"), pa.decimal128(9, 2))
VALUES = (np.nan, np.inf, -np.inf, -1, 0, 1, 2**31 - 1, -(2**31), 1e300, 1e9, -0.0, 5e-324)
NAMES = (
    *("", "x", "step", "action", "reward", "time_s", "truncated", "info.x", "term.x", "info.", "info.is_success"),
    *(
        "observation.touch",
        "observation.",
        "observation.proprioception",
        "info.a\x1b[2J",
        "term.\n",
        "é" * 300,
        "a.b.c",
    ),
)

Table = Any
Change = Callable[[Generator, Table], Table]


def changed_table(generator: Generator, table: Table) -> Table:
    """Return a table with one or two changes; one that cannot be made is left out."""
    for _ in range(int(generator.integers(1, 3))):
        try:
            table = pick(generator, CHANGES)(generator, table)
        except (pa.ArrowException, ValueError, TypeError, OverflowError, IndexError):
            continue
    return table


def write_table(generator: Generator, table: Table, path: Path) -> None:
    """Write a table as one of the kinds of Parquet; rarely as a stream or a file of Arrow's."""
    path.unlink(missing_ok=True)
    if generator.random() < 0.02:
        with pick(generator, (pa.ipc.new_file, pa.ipc.new_stream))(path, table.schema) as writer:
            writer.write_table(table)
        return
    pq.write_table(
        table,
        path,
        compression=pick(generator, ("zstd", "zstd", "none", "snappy", "gzip", "brotli", "lz4")),
        use_dictionary=bool(generator.random() < 0.3),
        version=pick(generator, ("2.6", "2.6", "1.0")),
        store_schema=bool(generator.random() < 0.9),
        data_page_version=pick(generator, ("1.0", "2.0")),
        row_group_size=pick(generator, (None, None, 1, 3)),
    )


def _dropped(generator: Generator, table: Table) -> Table:
    return table.remove_column(_column(generator, table))


def _renamed(generator: Generator, table: Table) -> Table:
    names = table.column_names
    names[_column(generator, table)] = pick(generator, (*NAMES, *names))
    return table.rename_columns(names)


def _added(generator: Generator, table: Table) -> Table:
    values = pick(generator, (table.column(_column(generator, table)), _any(generator, len(table))))
    place = int(generator.integers(table.num_columns + 1))
    nullable = bool(generator.random() < 0.5)
    return table.add_column(place, pa.field(pick(generator, NAMES), values.type, nullable), values)


def _moved(generator: Generator, table: Table) -> Table:
    return table.select([int(each) for each in generator.permutation(table.num_columns)])


def _of_another_type(generator: Generator, table: Table) -> Table:
    place = _column(generator, table)
    column = table.column(place).combine_chunks()
    make: Callable[[], Any] = pick(
        generator,
        (
            lambda: _cast(generator, column),
            lambda: _cast(generator, column),
            lambda: column.dictionary_encode(),
            lambda: pa.StructArray.from_arrays([column], ["element"]),
            lambda: pa.ListArray.from_arrays(pa.array(range(len(column) + 1), pa.int32()), column),
            lambda: pa.FixedSizeListArray.from_arrays(column, 1),
            lambda: pa.LargeListArray.from_arrays(pa.array(range(len(column) + 1), pa.int64()), column),
            lambda: _lists(generator, column),
            lambda: _any(generator, len(column)),
        ),
    )
    return _replaced(table, place, make(), bool(generator.random() < 0.5))


def _cast(generator: Generator, column: Any) -> Any:
    kind = pick(generator, KINDS)
    if pa.types.is_fixed_size_list(column.type):
        size = column.type.list_size
        return pa.FixedSizeListArray.from_arrays(column.flatten().cast(kind, safe=False), size)
    if pa.types.is_list(column.type):
        flat = column.flatten()
        parts = [flat.field(0), flat.field(1)]
        which = int(generator.integers(2))
        parts[which] = parts[which].cast(kind, safe=False)
        names = pick(generator, (["index", "value"], ["index", "value"], ["value", "index"], ["index", "other"]))
        return pa.ListArray.from_arrays(column.offsets, pa.StructArray.from_arrays(parts, names))
    return column.cast(kind, safe=False)


def _lists(generator: Generator, column: Any) -> Any:
    flat, size = column.flatten(), column.type.list_size
    if generator.random() < 0.5:
        return pa.ListArray.from_arrays(pa.array(np.arange(len(column) + 1, dtype=np.int32) * size), flat)
    return pa.array([row[: size - 1] for row in column.to_pylist()], pa.list_(column.type.value_type, size - 1))


def _with_nulls(generator: Generator, table: Table) -> Table:
    place = _column(generator, table)
    column = table.column(place).combine_chunks()
    gone = pa.array(generator.random(len(column)) < 0.3)
    nulls = pc.if_else(gone, pa.nulls(len(column), column.type), column)
    return _replaced(table, place, nulls, bool(generator.random() < 0.5))


def _nullable(generator: Generator, table: Table) -> Table:
    place = _column(generator, table)
    return _replaced(table, place, table.column(place).combine_chunks(), True)


def _longer(generator: Generator, table: Table) -> Table:
    rows = len(table)
    how = int(generator.integers(5))
    if how == 0:
        return table.slice(0, int(generator.integers(rows + 1)))
    if how == 1:
        return pa.concat_tables([table, table])
    if how == 2:
        return table.slice(int(generator.integers(rows)))
    if how == 3:
        return table.take(generator.permutation(rows))
    return table.slice(0, 0)


def _of_other_values(generator: Generator, table: Table) -> Table:
    """Return a table in which some numbers of a column are others: NaN, infinite, negative, large."""
    place = _column(generator, table)
    column = table.column(place).combine_chunks()
    kind = column.type
    if pa.types.is_fixed_size_list(kind):
        changed = pa.FixedSizeListArray.from_arrays(_other(generator, column.flatten()), type=kind)
    elif pa.types.is_list(kind):
        flat = column.flatten()
        parts = [_other(generator, flat.field(0)), _other(generator, flat.field(1))]
        changed = pa.ListArray.from_arrays(
            column.offsets, pa.StructArray.from_arrays(parts, fields=list(kind.value_type)), type=kind
        )
    else:
        changed = _other(generator, column)
    return _replaced(table, place, changed, table.schema.field(place).nullable)


def _other(generator: Generator, column: Any) -> Any:
    values = column.to_numpy(zero_copy_only=False).copy()
    some = generator.random(len(values)) < pick(generator, (0.05, 0.5, 1.0))
    with np.errstate(all="ignore"):
        values[some] = np.array(pick(generator, VALUES)).astype(values.dtype)
    return pa.array(values, column.type)


def _of_other_metadata(generator: Generator, table: Table) -> Table:
    metadata = dict(table.schema.metadata or {})
    if generator.random() < 0.1:
        return table.replace_schema_metadata(None)
    for key, content in metadata.items():
        data = changed_data(generator, json.loads(content))
        metadata[key] = json.dumps(data).encode(errors="replace")
    return table.replace_schema_metadata(metadata)


def _any(generator: Generator, rows: int) -> Any:
    """Return a column of any type, nested or not."""
    values = pick(generator, ([], None, "x", 1, 1.5, True, b"x", [1], {"a": [1]}, [[]], [{"index": 1, "value": None}]))
    return pa.array([values] * rows)


def _replaced(table: Table, place: int, column: Any, nullable: bool) -> Table:
    return table.set_column(place, pa.field(table.column_names[place], column.type, nullable), column)


def _column(generator: Generator, table: Table) -> int:
    return int(generator.integers(table.num_columns))


CHANGES: tuple[Change, ...] = (
    *(_dropped, _renamed, _added, _moved, _of_another_type, _of_another_type, _of_another_type),
    *(_with_nulls, _nullable, _longer, _of_other_values, _of_other_values, _of_other_metadata, _of_other_metadata),
)
"""What is tried; of what has many forms, more often."""

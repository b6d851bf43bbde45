"""What the table of an episode must be: columns of exact types, which follow from its description, and valid values."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from mimoc.bundle.regular_files import UnusableFileError
from mimoc.recording.arrow import pa
from mimoc.recording.blocks import Array, Reading
from mimoc.recording.described import ACTION, OBSERVATION, Described

STEP = "step"
NUMBERS = ("time_s", "reward")
FLAGS = ("terminated", "truncated")
MEASURE = "measure."
"""What the names of columns of quantities begin with."""
OPTIONAL = ("info.", "term.", MEASURE)
"""What the names of columns begin with that a table may have besides: numbers or flags."""
_SHOWN = 60
"""Most characters of a name or type in an error."""


def check_schema(schema: Any, described: Described) -> None:
    """Check that a table has the columns of its description, of exactly their types, and otherwise only optional ones.

    Raises:
        UnusableFileError: If it has not.
    """
    names, wanted = schema.names, columns_of(described)
    if missing := [name for name in wanted if name not in names]:
        raise UnusableFileError(f"the column {_shown(missing[0])} is missing")
    if len(set(names)) < len(names):
        raise UnusableFileError("it has two columns of one name")
    for field in schema:
        kinds = [wanted[field.name]] if field.name in wanted else _optional(field.name)
        if not kinds:
            raise UnusableFileError(f"the column {_shown(field.name)} is not one that mimoc writes")
        if field.nullable or field.type not in kinds:
            given = f"{field.type}{' or null' if field.nullable else ''}"
            raise UnusableFileError(f"the column {_shown(field.name)} is of type {_shown(given)}, not {kinds[0]}")


def columns_of(described: Described) -> Mapping[str, Any]:
    """Return the Arrow type of each column that a table with a description has; none of them has nulls."""
    actions = len(described.actions)
    columns = {STEP: pa.int32(), ACTION: lists_of(pa.float64(), actions)}
    columns |= dict.fromkeys(NUMBERS, pa.float64()) | dict.fromkeys(FLAGS, pa.bool_())
    for reading in described.readings:
        if reading.kind != "picture":
            columns[OBSERVATION + reading.name] = _type_of(reading)
    return {name: kind for name, kind in columns.items() if has_numbers(kind)}


def has_numbers(kind: Any) -> bool:
    """Return whether a column of this type is written: lists without numbers are not.

    Such are the actions of an infant whose joints are all locked. Parquet as pyarrow 26 writes it has no such lists:
    with a type that admits no nulls, writing them ends Python.
    """
    return not (pa.types.is_fixed_size_list(kind) and kind.list_size == 0)


def lists_of(number: Any, size: int) -> Any:
    """Return the type of lists of one length."""
    return pa.list_(pa.field("element", number, nullable=False), size)


def pairs_of(number: Any) -> Any:
    """Return the type of lists of the index and the value of numbers that are not zero."""
    pair = pa.struct([pa.field("index", pa.int32(), nullable=False), pa.field("value", number, nullable=False)])
    return pa.list_(pa.field("element", pair, nullable=False))


def check_rows(table: Any, described: Described, first_step: int) -> None:
    """Check the values of a table that has the columns of its description.

    Args:
        table: The table.
        described: Its description.
        first_step: What its first row must have as `step`.

    Raises:
        UnusableFileError: If there are nulls, steps that do not follow each other, actions that are no numbers, or
            indices that an observation does not have.
    """
    table.validate(full=True)
    for name in table.column_names:
        if any(map(_has_nulls, table.column(name).chunks)):
            raise UnusableFileError(f"the column {_shown(name)} has nulls")
    if not np.array_equal(table.column(STEP).to_numpy(), np.arange(first_step, first_step + len(table))):
        raise UnusableFileError(f"the column '{STEP}' does not count the control steps from {first_step}")
    acted = table.select([ACTION] if ACTION in table.column_names else []).slice(1 if first_step == 0 else 0)
    if not all(np.isfinite(chunk.flatten().to_numpy()).all() for column in acted.columns for chunk in column.chunks):
        raise UnusableFileError(f"the column '{ACTION}' has numbers that are not finite")
    for reading in described.readings:
        if reading.kind == "sparse":
            _check_indices(table, reading)


def sparse_of(table: Any, name: str) -> tuple[Array, Array, Array]:
    """Return row, index and value of all numbers of a sparse column that are not zero."""
    column = table.column(name).combine_chunks()
    rows = np.repeat(np.arange(len(column)), np.diff(column.offsets.to_numpy()))
    pairs = column.flatten()
    return rows, pairs.field("index").to_numpy(), pairs.field("value").to_numpy(zero_copy_only=False)


def _check_indices(table: Any, reading: Reading) -> None:
    rows, index, _ = sparse_of(table, OBSERVATION + reading.name)
    is_inside = (index >= 0).all() and (index < reading.size).all()
    if not is_inside or not ((np.diff(index) > 0) | (np.diff(rows) > 0)).all():
        raise UnusableFileError(
            f"the column '{OBSERVATION}{reading.name}' has an index that there is not, or one twice"
        )


def _type_of(reading: Reading) -> Any:
    number = pa.from_numpy_dtype(np.dtype(reading.dtype))
    return pairs_of(number) if reading.kind == "sparse" else lists_of(number, reading.size)


def _optional(name: str) -> list[Any]:
    return [pa.float64(), pa.bool_()] if name.startswith(OPTIONAL) else []


def _has_nulls(array: Any) -> bool:
    """Return whether an array has nulls, or the lists or pairs in it have."""
    if array.null_count:
        return True
    if pa.types.is_struct(array.type):
        return any(map(_has_nulls, array.flatten()))
    return pa.types.is_nested(array.type) and _has_nulls(array.flatten())


def _shown(text: object) -> str:
    """Return the beginning of a stranger's text in quotes, with what cannot be printed escaped."""
    return f"{str(text)[:_SHOWN]!r}"

"""States of an environment as plain data for JSON, from which they come back to the bit."""

import base64
import math
import zlib
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mimoc.base.errors import RecordingError

ARRAY, TUPLE, ITEMS, FLOAT = "array", "tuple", "items", "float"
"""Keys of dictionaries that stand for what JSON does not have; each is the only key that begins with `MARK`."""
MARK = "$"
KINDS = "biufcSU"
"""Kinds of arrays in states: numbers, complex ones too, and text."""
MOST_BYTES = 2**28
"""Of one array; the largest are the signals of a skin on their way."""


def to_plain(value: Any) -> Any:
    """Return what JSON can hold: arrays are compressed, floats are kept as they are."""
    if isinstance(value, np.generic):
        value = np.asarray(value)
    if isinstance(value, np.ndarray):
        if value.dtype.hasobject:
            raise RecordingError("an array of Python objects cannot be kept")
        data = base64.b64encode(zlib.compress(np.ascontiguousarray(value).tobytes(), 1)).decode()
        return {MARK + ARRAY: data, "dtype": value.dtype.str, "shape": list(value.shape)}
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else {MARK + FLOAT: str(value)}
    if isinstance(value, list):
        return [to_plain(item) for item in value]
    if isinstance(value, tuple):
        return {MARK + TUPLE: [to_plain(item) for item in value]}
    if isinstance(value, Mapping):
        if all(isinstance(key, str) and not key.startswith(MARK) for key in value):
            return {key: to_plain(item) for key, item in value.items()}
        return {MARK + ITEMS: [[to_plain(key), to_plain(item)] for key, item in value.items()]}
    raise RecordingError(f"an object of type {type(value).__name__} cannot be kept")


def from_plain(value: Any) -> Any:
    """Return what `to_plain` was given, numbers of NumPy's as arrays, or raise a RecordingError if it is damaged."""
    if isinstance(value, list):
        return [from_plain(item) for item in value]
    if not isinstance(value, dict):
        return value
    try:
        if MARK + ARRAY in value:
            return _array(base64.b64decode(value[MARK + ARRAY]), np.dtype(value["dtype"]), value["shape"])
        if MARK + FLOAT in value:
            return float(value[MARK + FLOAT])
        if MARK + TUPLE in value:
            return tuple(from_plain(item) for item in value[MARK + TUPLE])
        if MARK + ITEMS in value:
            return {from_plain(key): from_plain(item) for key, item in value[MARK + ITEMS]}
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError, zlib.error) as error:
        raise RecordingError(f"a state is damaged ({error})") from None
    return {key: from_plain(item) for key, item in value.items()}


def _array(packed: bytes, dtype: np.dtype, shape: Sequence[int]) -> np.ndarray:
    """Return an array, of which no more is unpacked than it says that there is."""
    size = math.prod(shape) * dtype.itemsize
    if dtype.kind not in KINDS or not 0 <= size <= MOST_BYTES:
        raise ValueError("an array is of another kind or size than any in a state")
    data = zlib.decompressobj().decompress(packed, size + 1)
    return np.frombuffer(data, dtype).reshape(shape).copy()


def is_same(ours: Any, theirs: Any) -> bool:
    """Return whether two states are the same to the bit; -0.0 is not 0.0, and NaN is NaN."""
    return to_plain(ours) == to_plain(theirs)

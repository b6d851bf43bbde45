"""What pages are made of: numbers as text and compressed arrays, and the files beside this module."""

import base64
import gzip
import json
from dataclasses import dataclass, field
from importlib import resources
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import MimocError
from mimoc.base.rounding import rounded

Array = npt.NDArray[Any]
KINDS = {"f": "<f4", "i": "<i2", "u": "<u4", "b": "|u1"}
"""How arrays are kept by kind of number: single precision, 16 bits with a sign, 32 without; bytes and booleans."""
FINE_M = 2e-5  # Resolution of places of which there are thousands.
ALIGNMENT = 4  # Alignment of each array in the block, in bytes.


@dataclass(frozen=True, slots=True)
class Places:
    """Thousands of places at some ages, which are kept as multiples of `FINE_M`: see `steps_of`."""

    places_m: Array  # Shape (ages, n, 3).


@dataclass(slots=True)
class EncodedArrays:
    """The arrays of a page."""

    arrays: list[Array] = field(default_factory=list)  # The arrays, in the order of their numbers.

    def put(self, value: Any) -> Any:
        """Keep the arrays in some data, and return it with `{"array": number}` in their places.

        Floats are kept in single precision, bytes as they are, other integers in 16 bits or, unsigned, in 32.

        Raises:
            OverflowError: If an integer does not fit.
        """
        if isinstance(value, dict):
            return {name: self.put(item) for name, item in value.items()}
        if isinstance(value, (list, tuple)):
            return [self.put(item) for item in value]
        if isinstance(value, Places):
            return {**self.put(steps_of(value.places_m)), "unit": FINE_M}
        if isinstance(value, bytes):
            value = np.frombuffer(value, np.uint8)
        if not isinstance(value, np.ndarray):
            return value
        kind = "b" if value.dtype in (np.uint8, np.bool_) else value.dtype.kind
        kept = value.astype(KINDS[kind])
        if kind in "iu" and not np.array_equal(kept, value):
            raise OverflowError(f"integers up to {value.max()} do not fit into {kept.dtype}")
        self.arrays.append(kept)
        return {"array": len(self.arrays) - 1}

    def encode(self, data: dict[str, Any]) -> dict[str, str]:
        """Return data, as JSON, and its arrays, as a compressed block in base64."""
        data = self.put(data)
        block, places = bytearray(), []
        for array in self.arrays:
            block += bytes(-len(block) % ALIGNMENT)
            places.append({"at": len(block), "kind": array.dtype.str[1:], "shape": list(array.shape)})
            block += array.tobytes()
        text = json.dumps(rounded({**data, "arrays": places}), separators=(",", ":"))
        return {"data": text.replace("<", "\\u003c"), "block": compressed(bytes(block))}


def compressed(content: bytes) -> str:
    """Return what pages contain of some bytes: compressed, in base64."""
    return base64.b64encode(gzip.compress(content, mtime=0)).decode()


def steps_of(places_m: Array) -> Array:
    """Return places, shape (ages, n, 3), as steps of `FINE_M` from each age to the next, the first from 0, as bytes.

    Their shape is (2, ages, 3, n): all low bytes and then all high bytes, by age and axis, since similar bytes that
    stand together compress to half.

    Raises:
        OverflowError: If a place is farther than 32767 steps, .65 m, from the origin.
    """
    whole = np.rint(places_m / FINE_M).astype(np.int64)
    if np.abs(whole).max(initial=0) > np.iinfo(np.int16).max:
        raise OverflowError(f"places up to {np.abs(places_m).max():.2f} m away do not fit into 16 bits")
    steps = np.moveaxis(np.diff(whole, axis=0, prepend=0), -1, 1).astype("<i2")  # What is too large wraps around twice.
    return np.moveaxis(np.ascontiguousarray(steps).view(np.uint8).reshape(*steps.shape, 2), -1, 0).copy()


FOLDER = resources.files("mimoc.viewer")


def source(name: str) -> str:
    """Return a text that goes into pages as it is."""
    return (FOLDER / "source" / name).read_text(encoding="utf-8")


def built(name: str) -> bytes:
    """Return a file that `.ci/task viewer` builds; MimocError if it is missing."""
    try:
        return (FOLDER / "built" / name).read_bytes()
    except FileNotFoundError:
        raise MimocError(f"mimoc/viewer/built/{name} is missing; in a checkout, `.ci/task viewer` builds it") from None

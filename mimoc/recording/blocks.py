"""Rows of a recording, gathered in arrays that are there beforehand."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import RecordingError
from mimoc.recording.movement_columns.reader import Samples
from mimoc.runtime.sense import Observation

Array = npt.NDArray[Any]
SPARSE_FROM = 1024
"""Observations of more numbers are kept as those that are not zero: touch has thousands, of which few are touched."""


@dataclass(frozen=True, slots=True)
class Reading:
    """One array of an observation."""

    name: str
    shape: tuple[int, ...]
    dtype: str
    kind: Literal["dense", "sparse", "picture"]
    """How it is kept: every number, those that are not zero, or as a frame of a video."""
    layout: tuple[str, ...] = ()
    """What each number is, with its unit; empty if nothing says so."""

    @property
    def size(self) -> int:
        """How many numbers it has."""
        return int(np.prod(self.shape))


def reading_of(name: str, array: Array, layout: Sequence[str] = ()) -> Reading:
    """Return how an array of an observation is kept, or raise a RecordingError if it is not one of numbers."""
    if array.dtype.kind not in "biuf":
        raise RecordingError(f"the observation '{name}' cannot be recorded: it is not an array of numbers")
    is_picture = array.dtype == np.uint8 and array.ndim == 3 and array.shape[-1] == 3
    kind = "picture" if is_picture else "sparse" if array.size > SPARSE_FROM else "dense"
    return Reading(name, array.shape, array.dtype.name, kind, tuple(layout) if len(layout) == array.size else ())


class Sparse:
    """Rows of a long array, of which those numbers are kept whose bits are not all zero."""

    def __init__(self, reading: Reading, rows: int):
        self._bits = np.dtype(f"u{np.dtype(reading.dtype).itemsize}")
        self.index = np.empty(64 * rows, np.int32)
        self.value = np.empty(64 * rows, reading.dtype)
        self.ends = np.zeros(rows + 1, np.int32)
        """Where the numbers of each row end; the first row begins at 0."""

    def put(self, row: int, array: Array) -> None:
        """Keep a row, which is the next one."""
        flat = array.reshape(-1)
        index = (flat.view(self._bits) != 0).nonzero()[0]
        start = self.ends[row]
        end = self.ends[row + 1] = start + len(index)
        if end > len(self.index):
            self.index, self.value = np.resize(self.index, 2 * end), np.resize(self.value, 2 * end)
        self.index[start:end] = index
        flat.take(index, out=self.value[start:end], mode="clip")

    def dense(self, rows: int, size: int) -> Array:
        """Return the first rows with all their zeros, shape (rows, size)."""
        array = np.zeros((rows, size), self.value.dtype)
        end = self.ends[rows]
        array[np.repeat(np.arange(rows), np.diff(self.ends[: rows + 1])), self.index[:end]] = self.value[:end]
        return array


class Block:
    """Some rows of an episode that follow each other: what was done, what it led to, and what was observed then."""

    def __init__(self, readings: Iterable[Reading], actuators: int, rows: int, first_step: int):
        """Make room for rows, of which the first comes after *first_step* control steps of its episode."""
        self.readings, self.first_step, self.room, self.rows = tuple(readings), first_step, rows, 0
        self.action = np.empty((rows, actuators))
        self.numbers: dict[str, Array] = {"time_s": np.empty(rows), "reward": np.empty(rows)}
        self.numbers |= {name: np.zeros(rows, bool) for name in ("terminated", "truncated")}
        self.dense, self.sparse = dict[str, Array](), dict[str, Sparse]()
        self.movement: list[Samples] = []
        """What movement columns need of all rows; empty if there are no such columns."""
        for reading in self.readings:
            if reading.kind == "sparse":
                self.sparse[reading.name] = Sparse(reading, rows)
            else:
                self.dense[reading.name] = np.empty((rows, *reading.shape), reading.dtype)

    @property
    def is_full(self) -> bool:
        """Whether there is no room left."""
        return self.rows == self.room

    def put(
        self,
        time_s: float,
        action: Array | None,
        judged: tuple[float, bool, bool, Mapping[str, Any]],
        observation: Observation,
    ) -> None:
        """Keep a row: reward, terminated, truncated and info of an action; it is None before the first one."""
        row, numbers = self.rows, self.numbers
        self.action[row] = np.nan if action is None else action
        numbers["time_s"][row] = time_s
        numbers["reward"][row], numbers["terminated"][row], numbers["truncated"][row], info = judged
        for name, value in info.items():
            if isinstance(value, Mapping):
                for term, amount in value.items():
                    self._column(f"term.{term}", amount)[row] = amount
            else:
                self._column(f"info.{name}", value)[row] = value
        for name, array in self.dense.items():
            array[row] = observation[name]
        for name, array in self.sparse.items():
            array.put(row, observation[name])
        self.rows += 1

    def put_measures(self, measures: Mapping[str, Any]) -> None:
        """Add quantities by name to the row that was put last; in rows without them they are NaN or False."""
        for name, value in measures.items():
            self._column(f"measure.{name}", value)[self.rows - 1] = value

    def _column(self, name: str, value: Any) -> Array:
        """Return the array of a number of the info; where there is none, it is NaN or False."""
        if name not in self.numbers:
            is_flag = isinstance(value, (bool, np.bool_))
            self.numbers[name] = np.zeros(self.room, bool) if is_flag else np.full(self.room, np.nan)
        return self.numbers[name]

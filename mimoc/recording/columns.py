"""What the schema of a recording's table says of its columns, in the metadata that every table carries."""

import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import groupby, takewhile
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import RecordingError
from mimoc.base.units import ms_to_s
from mimoc.bundle.regular_files import UnusableFileError, parse_json
from mimoc.runtime.sense import Observation
from mimoc.schema.base import Model
from mimoc.schema.entries import ControlStep, Count

if TYPE_CHECKING:  # Reading a recording must not load what movement columns need of an infant.
    from mimoc.recording.movement_columns import Samples

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
    layout: tuple[str, ...] = ()  # What each number is, with its unit; empty if nothing says so.

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
        self.readings = tuple(readings)
        self.first_step = first_step
        self.room = rows
        self.rows = 0
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
        if name not in self.numbers:
            is_flag = isinstance(value, (bool, np.bool_))
            self.numbers[name] = np.zeros(self.room, bool) if is_flag else np.full(self.room, np.nan)
        return self.numbers[name]


NUMBERED = re.compile(r"^(.*?)(\d+)(\D*)$")
WORD = re.compile(r"\w{1,100}")
MAX_LAYOUT = 5_000_000  # Names of all numbers of an observation; the densest skins have a tenth.
LONG = 100  # Layouts of fewer names are written out.


def compact_names(layout: Sequence[str]) -> list[Any]:
    """Return a layout as it stands in files: names, or runs `{"name", "from", "to", "ends"}` of numbered names."""
    if len(layout) < LONG:
        return list(layout)
    items: list[Any] = []
    for prefix, names in groupby(layout, key=lambda name: (match := NUMBERED.match(name)) and match[1]):
        run = list(names)
        short = None if prefix is None else _run(prefix, run)
        items += run if short is None else [short]
    return items


def expand_names(layout: Sequence[Any]) -> tuple[str, ...]:
    """Return the names of a layout as it stands in files."""
    runs = [item for item in layout if not isinstance(item, str)]
    numbered = sum(max(0, run["to"] + 1 - run["from"]) * len(run["ends"]) for run in runs)
    if len(layout) - len(runs) + numbered > MAX_LAYOUT:
        raise ValueError("a layout of more numbers than any infant has")
    return tuple(name for item in layout for name in ([item] if isinstance(item, str) else _names(item)))


def _run(prefix: str, names: Sequence[str]) -> dict[str, Any] | None:
    parts = [match for name in names if (match := NUMBERED.match(name))]
    first = parts[0][2]
    ends = [part[3] for part in takewhile(lambda part: part[2] == first, parts)]
    run = {"name": prefix, "from": int(first), "to": int(parts[-1][2]), "ends": ends}
    return run if _names(run) == list(names) else None


def _names(run: Mapping[str, Any]) -> list[str]:
    numbers = range(run["from"], run["to"] + 1)
    return [f"{run['name']}{number}{end}" for number in numbers for end in run["ends"]]


KEY = b"mimoc"  # Key of the description in the schema's metadata.
OBSERVATION = "observation."  # What the names of the columns of observations begin with.
MAX_NUMBERS = 2**26  # Most numbers of one array of an observation; pictures have the most.
MAX_NAME = 200  # Characters of the name of an observation, which is part of the names of files.
ACTION = "action"
MOVEMENT, MOVEMENT_NAMES = "movement", "movement_names"  # Movement columns of numbers, and of texts.
_Whole = Literal["int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64"]
Dtype = Literal["float16", "float32", "float64", _Whole, "bool"]
"""NumPy's name of the type of an array of an observation."""


class _Run(Model, alias_generator=lambda name: name.removesuffix("_")):
    """Numbered names, as `compact_names` writes them."""

    name: str
    from_: Count
    to: Count
    ends: list[str]


class _Column(Model):
    layout: tuple[str | _Run, ...]


class _Observation(_Column):
    kind: Literal["dense", "sparse", "picture"]
    shape: tuple[Count, ...]
    dtype: Dtype


class _Table(Model):
    recording: Literal[1]
    step_ms: ControlStep
    columns: dict[str, _Observation | _Column]


@dataclass(frozen=True)
class Described:
    """What the schema of a recording says of its columns."""

    readings: tuple[Reading, ...]
    actions: tuple[str, ...]
    step_ms: float
    movement: tuple[str, ...] = ()  # Movement columns of numbers.
    movement_names: tuple[str, ...] = ()  # Movement columns of texts.

    @property
    def rate_hz(self) -> Fraction:
        """How many control steps, and pictures, there are in a second."""
        return 1 / Fraction(ms_to_s(self.step_ms)).limit_denominator(1_000_000)

    @cached_property
    def json(self) -> bytes:
        """It as it stands in the metadata."""
        observations = {
            OBSERVATION + reading.name: {
                "kind": reading.kind,
                "shape": list(reading.shape),
                "dtype": reading.dtype,
                "layout": compact_names(reading.layout),
            }
            for reading in self.readings
        }
        columns = {ACTION: {"layout": compact_names(self.actions)}, **observations}
        for name, layout in ((MOVEMENT, self.movement), (MOVEMENT_NAMES, self.movement_names)):
            columns |= {name: {"layout": compact_names(layout)}} if layout else {}
        return json.dumps({"recording": 1, "step_ms": self.step_ms, "columns": columns}, ensure_ascii=False).encode()

    @classmethod
    def from_json(cls, text: bytes) -> "Described":
        """Return what metadata says, or raise an UnusableFileError if it is not what `json` returns."""
        table = parse_json(text, _Table)
        columns = dict(table.columns)
        actions = columns.pop(ACTION, None)
        if actions is None or isinstance(actions, _Observation):
            raise UnusableFileError(f"columns.{ACTION}: it must be described by its layout")
        movement = [_movement(name, columns.pop(name, None)) for name in (MOVEMENT, MOVEMENT_NAMES)]
        readings = tuple(_reading(name, column) for name, column in columns.items())
        return cls(readings, _layout(ACTION, actions.layout), table.step_ms, *movement)


def _movement(name: str, column: _Column | None) -> tuple[str, ...]:
    layout = _layout(name, column.layout) if column else ()
    if len(set(layout)) < len(layout) or not all(WORD.fullmatch(item) for item in layout):
        raise UnusableFileError(
            f"columns.{name}.layout: it has what is not the name of a movement column, or one twice"
        )
    return layout


def _reading(column_name: str, column: _Column) -> Reading:
    place = f"columns.{column_name!r:.{MAX_NAME}}"
    name = column_name.removeprefix(OBSERVATION)
    if not isinstance(column, _Observation) or name == column_name:
        raise UnusableFileError(f"{place}: it is not a column that mimoc describes")
    if not 0 < len(name) < MAX_NAME or not name.isprintable() or "/" in name:
        raise UnusableFileError(f"{place}: it is not the name of an observation")
    shape = column.shape
    if math.prod(shape) > MAX_NUMBERS or max(shape, default=0) > MAX_NUMBERS:
        raise UnusableFileError(f"{place}.shape: more numbers than any infant observes")
    if column.kind == "picture" and not (column.dtype == "uint8" and len(shape) == 3 and shape[2] == 3 and all(shape)):
        raise UnusableFileError(f"{place}.shape: it is not that of a picture")
    reading = Reading(name, shape, column.dtype, column.kind, _layout(place, column.layout))
    if len(reading.layout) not in (0, reading.size):
        raise UnusableFileError(f"{place}.layout: {len(reading.layout)} names for {reading.size} numbers")
    return reading


def _layout(place: str, layout: Sequence[str | _Run]) -> tuple[str, ...]:
    try:
        return expand_names([item if isinstance(item, str) else item.model_dump(by_alias=True) for item in layout])
    except ValueError as error:
        raise UnusableFileError(f"{place}.layout: {error}") from None

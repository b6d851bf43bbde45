"""What the schema of a recording's table says of its columns, in the metadata that every table carries."""

import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import groupby, takewhile
from typing import Any, Literal

from mimoc.base.units import ms_to_s
from mimoc.bundle.regular_files import UnusableFileError, parse_json
from mimoc.recording.blocks import Reading
from mimoc.schema.base import Model
from mimoc.schema.entries import ControlStep, Count

NUMBERED = re.compile(r"^(.*?)(\d+)(\D*)$")
WORD = re.compile(r"\w{1,100}")
MOST = 5_000_000
"""Names of all numbers of an observation; the densest skins have a tenth."""
LONG = 100
"""Layouts of fewer names are written out."""


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
    if len(layout) - len(runs) + numbered > MOST:
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


KEY = b"mimoc"
"""Key of the description in the schema's metadata."""
OBSERVATION = "observation."
"""What the names of the columns of observations begin with."""
MOST_NUMBERS = 2**26
"""Of one array of an observation; pictures have the most."""
MOST_NAME = 200
"""Characters of the name of an observation, which is part of the names of files."""
ACTION = "action"
MOVEMENT, MOVEMENT_NAMES = "movement", "movement_names"
"""Movement columns of numbers, and of texts."""
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
    movement: tuple[str, ...] = ()
    """Movement columns of numbers."""
    movement_names: tuple[str, ...] = ()
    """Movement columns of texts."""

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
    """Return the names of movement columns, which must be words; none of recordings that do not have them."""
    layout = _layout(name, column.layout) if column else ()
    if len(set(layout)) < len(layout) or not all(WORD.fullmatch(item) for item in layout):
        raise UnusableFileError(
            f"columns.{name}.layout: it has what is not the name of a movement column, or one twice"
        )
    return layout


def _reading(column_name: str, column: _Column) -> Reading:
    """Return an array of an observation, which must be one that an infant can have."""
    place, name = f"columns.{column_name!r:.{MOST_NAME}}", column_name.removeprefix(OBSERVATION)
    if not isinstance(column, _Observation) or name == column_name:
        raise UnusableFileError(f"{place}: it is not a column that mimoc describes")
    if not 0 < len(name) < MOST_NAME or not name.isprintable() or "/" in name:
        raise UnusableFileError(f"{place}: it is not the name of an observation")
    shape = column.shape
    if math.prod(shape) > MOST_NUMBERS or max(shape, default=0) > MOST_NUMBERS:
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

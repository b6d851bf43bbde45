"""Comparing what happens again with what was recorded, number by number and bit by bit."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

import numpy as np

from mimoc.errors import RecordingError
from mimoc.recording import frames, tables
from mimoc.recording.blocks import Array, Block, Reading
from mimoc.recording.described import OBSERVATION
from mimoc.recording.reading import Episode
from mimoc.recording.state_text import is_same

Number = tuple[int, str, int, float, float]
"""Row, array, index in it, and both values of a number that differs."""
ALLOWED_LATER = "truncated"
"""A limit of steps around the environment ends an episode, of which the infant itself knows nothing."""


@dataclass(frozen=True, slots=True)
class Difference:
    """The first number of an episode that is not as it was recorded."""

    step: int
    """Control steps before it."""
    what: str
    """The array that it is in, such as `proprioception`, `reward` or `state`."""
    name: str
    """Which number of it, with its unit, as far as it has a name."""
    recorded: float
    now: float

    def __str__(self) -> str:
        """Return it in one line."""
        of = f" {self.name}" if self.name else ""
        if np.isnan(self.recorded) and np.isnan(self.now):
            return f"step {self.step}: {self.what}{of} differs"
        by = abs(self.now - self.recorded)
        return f"step {self.step}: {self.what}{of} was {self.recorded:.9g}, is {self.now:.9g} (by {by:.3g})"


class Recorded:
    """The rows of an episode, taken one part after the other."""

    def __init__(self, episode: Episode):
        """Begin with its first row."""
        self._episode, self._taken = episode, 0
        pictures = [reading for reading in episode.described.readings if reading.kind == "picture"]
        self._pictures = {reading.name: _frames(episode, reading) for reading in pictures}

    def differs(self, block: Block) -> Difference | None:
        """Compare the next rows; return the first difference in time, if there is one."""
        rows = self._episode.table.slice(self._taken, block.rows)
        first = self._taken
        self._taken += block.rows
        numbers = [number for number in self._differences(rows, block) if number is not None]
        if not numbers:
            return None
        row, what, index, recorded, now = min(numbers, key=itemgetter(0))
        return Difference(first + row, what, _label(self._episode, what, index), recorded, now)

    def _differences(self, rows: Any, block: Block) -> Iterator[Number | None]:
        for reading in block.readings:
            name = reading.name
            if reading.kind == "picture":
                recorded = np.stack([next(self._pictures[name]) for _ in range(block.rows)])
            else:
                recorded = tables.array_of(rows, OBSERVATION + name, reading)
            is_sparse = reading.kind == "sparse"
            now = block.sparse[name].dense(block.rows, reading.size) if is_sparse else block.dense[name][: block.rows]
            yield _first(name, recorded, now)
        terms = {name for name in rows.column_names if name.startswith("term.")}
        for name in sorted(block.numbers.keys() | terms):
            now = block.numbers.get(name, np.full(block.room, np.nan))[: block.rows]
            known = name in rows.column_names
            recorded = tables.array_of(rows, name) if known else np.full_like(now, np.nan if now.dtype == float else 0)
            if name == ALLOWED_LATER:
                recorded = recorded & now
            yield _first(name.partition(".")[2] or name, recorded, now)


def state_differs(step: int, recorded: Mapping[str, Any], now: Mapping[str, Any]) -> Difference | None:
    """Compare two complete states; return the first part that differs."""
    for part, ours in recorded.items():
        theirs = now.get(part)
        if not is_same(ours, theirs):
            if (
                isinstance(ours, np.ndarray)
                and isinstance(theirs, np.ndarray)
                and ours.shape == theirs.shape
                and (number := _first(part, ours[None], theirs[None]))
            ):
                return Difference(step, "state", f"{part} {number[2]}", *number[3:])
            return Difference(step, "state", part, np.nan, np.nan)
    return None


def _first(what: str, recorded: Array, now: Array) -> Number | None:
    """Return the first number whose bits differ."""
    ours, theirs = (np.ascontiguousarray(array).reshape(len(array), -1) for array in (recorded, now))
    if ours.dtype != theirs.dtype:
        ours, theirs = ours.astype(float), theirs.astype(float)
    differs = _bits(ours) != _bits(theirs)
    if not differs.any():
        return None
    row, index = np.argwhere(differs)[0].tolist()
    return row, what, index, float(ours[row, index]), float(theirs[row, index])


def _bits(array: Array) -> Array:
    """Return numbers as whole ones, so that -0.0 is not 0.0 and NaN is NaN."""
    return np.ascontiguousarray(array).view(f"u{array.itemsize}")


def _label(episode: Episode, what: str, index: int) -> str:
    """Return the name of a number in an array of the observation, or where it is in a picture."""
    reading = {reading.name: reading for reading in episode.described.readings}.get(what)
    if reading is None or index >= reading.size:  # A number of the info may have the name of an observation.
        return ""
    if reading.layout:
        return f"'{reading.layout[index]}'"
    at = ", ".join(str(place) for place in np.unravel_index(index, reading.shape or (1,)))
    return f"at ({at})"


def _frames(episode: Episode, reading: Reading) -> Iterator[Any]:
    paths = episode.videos(reading.name)
    for path in paths:
        yield from frames.decoded(path, reading.shape, episode.sidecar.rows)
    raise RecordingError(f"{paths[-1]}: there are fewer pictures in it than control steps")

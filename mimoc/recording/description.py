"""What a recording says of itself in JSON: its description, and the sidecar of each episode or part."""

import base64
import math
import os
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np

from mimoc.base.errors import RecordingError
from mimoc.bundle.regular_files import UnusableFileError, read_json_file
from mimoc.schema.base import Model
from mimoc.schema.entries import ControlStep, Count, Digest, Number, Size

RECORDING = "recording.json"
FORMAT: Literal[1] = 1
MAX_BYTES = 2**29  # Largest size of a description or a sidecar, which has all states of an episode; 512 MB.
UNFINISHED = "unfinished"  # How an episode ended that is still being recorded, or was when its process was killed.

Data = TypeVar("Data", bound=Model)


class RecordedInfant(Model):
    """One of the infants that were recorded side by side."""

    name: str
    """Name of its spec, or in its world."""
    bundle: Digest
    """Digest of its bundle, or of its world's."""
    world: Count | None = None
    """Number of the world that it shares with others; None if it is alone."""


class Mark(Model):
    """A place in a run that the recording can come back to."""

    run: str
    """Name of the run."""
    steps: Count
    """Control steps of the run before this place."""
    episodes: tuple[Count, ...]
    """Number of each infant's next episode."""


class Description(Model):
    """Content of `recording.json`."""

    recording: Literal[1]
    """Version of the format."""
    step_ms: ControlStep
    """Duration of a control step."""
    infants: tuple[RecordedInfant, ...]
    """The infants, side by side."""
    sessions: tuple[dict[str, str], ...]
    """Versions of the software, each time that they had changed."""
    marks: tuple[Mark, ...] = ()
    """Places in runs, the latest last."""
    note: str | None = None
    """Why it cannot be replayed, and what it lacks; None if it is complete."""

    def sharing(self, infant: int) -> tuple[int, ...]:
        """Return the numbers of the infants that share the world of one, with its own."""
        world = self.infants[infant].world
        if world is None:
            return (infant,)
        return tuple(number for number, other in enumerate(self.infants) if other.world == world)


class Reset(Model):
    """How an episode began."""

    seed: Count | None
    """Its seed; None if random numbers went on."""
    options: dict[str, Any]
    """Its options, as `to_plain` returns them."""
    before: dict[str, Any]
    """Parts of the state that it went on from, as `to_plain` returns them; of a world, kept with its first infant."""


class Change(Model):
    """Something that was done to an infant besides a control step: one of these, after a number of steps."""

    step: Count
    """Control steps before it."""
    infant: Count | None = None
    """Number of the infant, if it is in a world with others: the first whose episode goes on keeps those of all."""
    age_months: Number | None = None
    """Age that it has grown to."""
    state: dict[str, Any] | None = None
    """Complete state that was restored."""
    expression: str | None = None
    """Facial expression that it has had since."""
    arousal: Number | None = None
    """Arousal that it has had since."""
    order: dict[str, Any] | None = None
    """What a companion was asked to do."""
    physics: dict[str, Any] | None = None
    """State of the simulation that a script has set."""
    action_dtype: str | None = None
    """Type of the actions since."""

    @property
    def kinds(self) -> list[str]:
        """Which of them it is: one."""
        return [name for name, value in self if name not in ("step", "infant") and value is not None]


class KeptState(Model):
    """A complete state after some control steps, as `to_plain` returns it."""

    step: Count
    state: dict[str, Any]


class Part(Model):
    """Sidecar of a part of an episode after the first one."""

    rows: Size
    """Rows of its table."""
    changes: tuple[Change, ...]
    """What was done besides control steps, in order."""
    states: tuple[KeptState, ...]
    """Complete states, in order."""
    ended: str = UNFINISHED
    """How the episode ended, if this is its last part."""


class Sidecar(Part):
    """Sidecar of an episode or of its first part."""

    infant: Count
    """Which of the infants that were recorded side by side."""
    bundle: Digest
    """Digest of its bundle."""
    versions: dict[str, str]
    """Versions of the software that it was recorded with."""
    objects: dict[str, str] | None = None
    """Classes of the objects of a script's own, by what they are."""
    reset: Reset | None
    """Its reset; None if it began without one."""
    start: dict[str, Any]
    """Complete state before the first control step, as `to_plain` returns it; empty if another infant keeps it."""


class _Version(Model, extra="ignore"):
    recording: int


def description_in(folder: Path) -> Description:
    """Return the `recording.json` of a folder, or raise a RecordingError if there is none or it is damaged."""
    path = folder / RECORDING
    if not folder.is_dir():
        raise RecordingError(f"{folder}: there is no such folder; record one with 'mimoc run INFANT --record DIR'")
    if not os.path.lexists(path):
        raise RecordingError(f"{folder}: this is not a recording, it has no {RECORDING}")
    if read_data(path, _Version, below=folder).recording != FORMAT:
        raise RecordingError(f"{path}: this version of mimoc reads recordings of version {FORMAT} only")
    description = read_data(path, Description, below=folder)
    infants = len(description.infants)
    if not infants or any(len(mark.episodes) != infants for mark in description.marks):
        raise RecordingError(
            f"{path}: marks: each must have a number for each of the {infants} infants, of whom there is at least one"
        )
    return description


def read_sidecar(paths: Sequence[Path], *, below: Path) -> Sidecar:
    """Return what the sidecars of the parts of an episode say together, or raise a RecordingError if one is damaged."""
    first = read_data(paths[0], Sidecar, below=below)
    parts = (first, *(read_data(path, Part, below=below) for path in paths[1:]))
    for path, part in zip(paths, parts, strict=True):
        for number, change in enumerate(part.changes):
            if len(change.kinds) != 1:
                raise RecordingError(f"{path}: changes.{number}: it must be one change, not {len(change.kinds)}")
    return first.model_copy(
        update={
            "rows": sum(part.rows for part in parts),
            "changes": tuple(change for part in parts for change in part.changes),
            "states": tuple(state for part in parts for state in part.states),
            "ended": parts[-1].ended,
        }
    )


def read_data(path: Path, kind: type[Data], *, below: Path) -> Data:
    """Return the content of a JSON file of a recording, or raise a RecordingError if it is missing or damaged."""
    try:
        data = read_json_file(path, kind, MAX_BYTES, below=below)
    except UnusableFileError as error:
        raise RecordingError(f"{path}: {error}") from None
    if data is None:
        raise RecordingError(f"{path}: the file is missing")
    return data


ARRAY, TUPLE, ITEMS, FLOAT = "array", "tuple", "items", "float"
"""Keys of dictionaries that stand for what JSON does not have; each is the only key that begins with `MARK`."""
MARK = "$"
KINDS = "biufcSU"  # Kinds of arrays in states: numbers, complex ones too, and text.
MAX_ARRAY_BYTES = 2**28  # Largest size of one array; the largest are the signals of a skin on their way.


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
    if dtype.kind not in KINDS or not 0 <= size <= MAX_ARRAY_BYTES:
        raise ValueError("an array is of another kind or size than any in a state")
    data = zlib.decompressobj().decompress(packed, size + 1)
    return np.frombuffer(data, dtype).reshape(shape).copy()


def is_same(ours: Any, theirs: Any) -> bool:
    """Return whether two states are the same to the bit; -0.0 is not 0.0, and NaN is NaN."""
    return to_plain(ours) == to_plain(theirs)

"""Folders in which each frame of a film has a file of its own."""

import math
import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from functools import reduce
from itertools import accumulate, pairwise
from pathlib import Path
from statistics import median
from typing import Any

from pydantic_core import from_json

from mimoc.bundle.regular_files import (
    UnusableFileError,
    is_regular_file,
    one_line,
    open_regular_file,
    read_regular_file,
    regular_files,
)

MAX_FRAMES = 2**18  # Most frames of a recording: 2.4 hours at 30 frames a second.
MAX_FRAME_BYTES = 2**20
MAX_FILE_BYTES = 2**27
_MAX_BYTES = 2**29
_FIRST_BYTES = 2**16
_MAX_DIGITS = 19  # Most digits of the number of a frame: those of nanoseconds since 1970.
_MIN_STAMP, _STAMP_JITTER, _MAX_STAMPS = 5, 0.25, 0.7
"""Time stamps rise by this much a frame or more; most of their steps, by this share, are as long as the median."""
_NUMBER = re.compile("[0-9]+")
_ENDING = re.compile(r"\.[A-Za-z][A-Za-z0-9]*$")
_CLOCK = re.compile(
    r"(?<![0-9])((?:19|20)[0-9]{2})[-_.]?([0-9]{2})[-_.]?([0-9]{2})[-_ T.]+"
    r"([0-9]{2})[-_.:h]?([0-9]{2})[-_.:m]?([0-9]{2})(?:[-_.,]([0-9]{3}|[0-9]{6}))?(?![0-9])"
)
"""A date and a time of day, as in `2024-01-31_10-59-59.033`."""
_MILLI = 3  # Digits of milliseconds; microseconds have twice as many.


@dataclass(frozen=True, slots=True)
class FrameFiles:
    """The files of the frames of a recording, in the order of time."""

    names: tuple[str, ...]
    contents: tuple[bytes, ...]
    places: tuple[int, ...]  # Index of each frame, from 0; where a number is missing there is a gap.
    notes: tuple[str, ...]

    @property
    def frames(self) -> int:
        """Number of frames, with those that are missing."""
        return self.places[-1] + 1


def read_frame_files(folder: Path, suffix: str) -> FrameFiles:
    """Return files that end in *suffix* by the rising number in their names, or raise an UnusableFileError."""
    names = frame_names(folder, suffix)
    if not names:
        raise UnusableFileError(f"has no files *{suffix}; give the folder that they are in")
    if len(names) > MAX_FRAMES:
        raise UnusableFileError(f"has {len(names):,} frames; mimoc reads up to {MAX_FRAMES:,}: cut it")
    numbers = frame_numbers([name.removesuffix(suffix) for name in names])
    numbered = sorted(zip(numbers or range(len(names)), names, strict=True))
    ordered = tuple(name for _, name in numbered)
    places, notes = frame_places([number for number, _ in numbered], ordered)
    try:
        with regular_files(folder, _MAX_BYTES) as files:
            return FrameFiles(ordered, tuple(files.read_all(ordered, MAX_FRAME_BYTES)), places, notes)
    except OSError as error:
        raise UnusableFileError(f"cannot be read ({error.strerror}); check its permissions") from None


def frame_numbers(names: Sequence[str]) -> list[int] | None:
    """Return the number of each frame by its name; None if one has none.

    Of several numbers in a name, such as in `2024-01-01_cam2_0001`, it is the one that differs in all names; of several
    of these, such as a counter and a time stamp, the one with the fewest gaps. Where no number differs in all, it is
    the last that differs at all. Dates with times of day that differ are one number, in microseconds.
    """
    clocks = {clock.groups()[:-1] for name in names for clock in _CLOCK.finditer(name)}
    found = [_numbers(_CLOCK.sub(_microseconds, name) if len(clocks) > 1 else name) for name in names]
    if not found or not all(found):
        return None
    is_alike = len({len(numbers) for numbers in found}) == 1
    columns = [*zip(*found, strict=True)] if is_alike else [tuple(numbers[-1] for numbers in found)]
    varied = [column for column in columns if len({*column}) > 1] or columns[-1:]
    unique = [column for column in varied if len({*column}) == len(column)]
    return [*min(reversed(unique), key=lambda column: max(column) - min(column), default=varied[-1])]


def numbers_of_files(names: Sequence[str]) -> list[int] | None:
    """Return `frame_numbers` by the names of files without suffixes, or of their folders if files are all alike."""
    stems = [_ENDING.sub("", re.split(r"[/\\]", name)[-1]) for name in names]
    return frame_numbers(stems if len({*stems}) > 1 else names)


def frame_places(numbers: Sequence[int], names: Sequence[str]) -> tuple[tuple[int, ...], tuple[str, ...]]:
    """Return the index of each frame by its number, which rise, and what is to be said of it.

    Numbers that are all multiples of one, as of every second frame, are divided by it. Numbers that rise by about as
    much from frame to frame, as time stamps do, are divided by that and rounded.

    Raises:
        UnusableFileError: If a number is there twice, or there are too many.
    """
    steps = [after - before for before, after in pairwise(numbers)]
    if 0 in steps:
        first = steps.index(0)
        twice = f"{one_line(names[first])} and {one_line(names[first + 1])} have the same number"
        raise UnusableFileError(f"{twice}; give a folder with one recording")
    every = reduce(math.gcd, steps, 0) or 1
    usual = median(steps) / every if steps else 1
    notes = []
    if usual >= _MIN_STAMP and _share_near(steps, usual * every) >= _MAX_STAMPS:
        places = (0, *accumulate(max(1, round(step / (usual * every))) for step in steps))
        notes = [f"numbers of frames rise by about {usual * every:g}, as time stamps do, and are divided by that"]
    else:
        places = tuple((number - numbers[0]) // every for number in numbers)
        notes = [f"every {every} frames have a number of their own; the frame rate is that of those"] * (every > 1)
    if places[-1] >= MAX_FRAMES:
        raise UnusableFileError(f"frames are numbered up to {numbers[-1]:,}; mimoc reads up to {MAX_FRAMES:,}: cut it")
    missing = places[-1] + 1 - len(places)
    return places, (*notes, *([f"{missing:,} of {places[-1] + 1:,} frames are missing"] if missing else []))


def frame_names(folder: Path, suffix: str) -> list[str]:
    """Return the sorted names in a folder that end in *suffix*; none if it is no folder."""
    try:
        return sorted(name for name in os.listdir(folder) if name.endswith(suffix) and not name.startswith("."))
    except OSError:
        return []


def first_bytes(path: Path) -> bytes:
    """Return the first bytes of a file, or of the first JSON file of a folder; none of a link."""
    if path.is_dir():
        names = frame_names(path, ".json")
        path = path / names[0] if names else path
    try:
        file = open_regular_file(path, MAX_FILE_BYTES, below=path.parent)
    except UnusableFileError:
        return b""
    if file is None:
        return b""
    with file:
        return file.read(_FIRST_BYTES)


def read_whole_file(path: Path) -> bytes:
    """Return the content of a file with all frames, or raise an UnusableFileError."""
    if is_regular_file(path) and path.stat().st_size > MAX_FILE_BYTES:
        raise UnusableFileError(f"is larger than {MAX_FILE_BYTES >> 20} MB, the most that mimoc reads; cut it")
    content = read_regular_file(path, MAX_FILE_BYTES)
    if content is None:
        raise UnusableFileError("cannot be read; check the path and its permissions")
    return content


def _numbers(name: str) -> list[int]:
    texts = _NUMBER.findall(name)
    return [int(text) for text in texts] if max(map(len, texts), default=0) <= _MAX_DIGITS else []


def _microseconds(clock: re.Match[str]) -> str:
    """Return a date and time of day as one number; as it stands, if there is no such time."""
    year, month, day, hour, minute, second, fraction = (int(text) for text in clock.groups(default="0"))
    microsecond = fraction * 1000 if len(clock[7] or "") == _MILLI else fraction
    try:
        moment = datetime(year, month, day, hour, minute, second, microsecond, tzinfo=UTC)
    except ValueError:
        return clock[0]
    return str((moment - datetime.min.replace(tzinfo=UTC)) // timedelta(microseconds=1))


def _share_near(steps: Sequence[int], usual: float) -> float:
    return sum(abs(step / usual - 1) < _STAMP_JITTER for step in steps) / len(steps)


def parse_frames(files: FrameFiles) -> Iterator[tuple[int, str, Any]]:
    """Yield index in time, name and data of each file; an UnusableFileError says which is damaged."""
    for place, name, content in zip(files.places, files.names, files.contents, strict=True):
        yield place, name, parse(content, name)


def parse(content: bytes, name: str = "") -> Any:
    """Return the data of a file; an UnusableFileError says where it is damaged."""
    try:
        return from_json(content)
    except ValueError as error:
        where = f"{one_line(name)}: " if name else ""
        raise UnusableFileError(f"{where}is damaged JSON ({one_line(str(error))}); export it again") from None


def objects(data: Any, where: str, key: str = "") -> Sequence[dict[str, Any]]:
    """Return a list of JSON objects, or what is one under a key of an object, or raise an UnusableFileError."""
    items = data.get(key) if key and isinstance(data, dict) else data
    if not isinstance(items, list) or not all(isinstance(item, dict) for item in items):
        what = f"no list '{key}' of persons" if key else "no list of persons"
        raise UnusableFileError(f"{one_line(where)}: {what}; export it again, or give another format")
    return items

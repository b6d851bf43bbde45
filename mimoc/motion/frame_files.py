"""Folders in which each frame of a film has a file of its own."""

import math
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import pairwise
from pathlib import Path

from mimoc.bundle.regular_files import (
    UnusableFileError,
    is_regular_file,
    one_line,
    open_regular_file,
    read_regular_file,
    regular_files,
)

MOST_FRAMES = 2**18
"""Of a recording: 2.4 hours at 30 frames a second."""
MOST_FRAME_BYTES = 2**20
"""Of the file of a frame."""
MOST_FILE_BYTES = 2**27
"""Of a file with all frames."""
_MOST_BYTES = 2**29
"""Of all files of a folder."""
_FIRST_BYTES = 2**16


@dataclass(frozen=True, slots=True)
class FrameFiles:
    """The files of the frames of a recording, in the order of time."""

    names: tuple[str, ...]
    contents: tuple[bytes, ...]
    places: tuple[int, ...]
    """Index of each frame, from 0; where a number is missing there is a gap."""
    notes: tuple[str, ...]

    @property
    def frames(self) -> int:
        """Number of frames, with those that are missing."""
        return self.places[-1] + 1


def read_frame_files(folder: Path, suffix: str) -> FrameFiles:
    """Return the files of a folder whose names end in *suffix*, by the last number in each name.

    Raises:
        UnusableFileError: If there are none, too many or too large ones, or two of one number.
    """
    names = frame_names(folder, suffix)
    if not names:
        raise UnusableFileError(f"has no files *{suffix}; give the folder that they are in")
    if len(names) > MOST_FRAMES:
        raise UnusableFileError(f"has {len(names):,} frames; mimoc reads up to {MOST_FRAMES:,}: cut it")
    numbers = [_number(name.removesuffix(suffix)) for name in names]
    known = [number for number in numbers if number is not None]
    numbered = sorted(zip(known if len(known) == len(names) else range(len(names)), names, strict=True))
    ordered = tuple(name for _, name in numbered)
    places, notes = frame_places([number for number, _ in numbered], ordered)
    try:
        with regular_files(folder, _MOST_BYTES) as files:
            return FrameFiles(ordered, tuple(files.read_all(ordered, MOST_FRAME_BYTES)), places, notes)
    except OSError as error:
        raise UnusableFileError(f"cannot be read ({error.strerror}); check its permissions") from None


def frame_places(numbers: Sequence[int], names: Sequence[str]) -> tuple[tuple[int, ...], tuple[str, ...]]:
    """Return the index of each frame by its number, which rise, and what is to be said of it.

    Numbers that are all multiples of one, as of every second frame, are divided by it.

    Raises:
        UnusableFileError: If a number is there twice, or there are too many.
    """
    steps = [after - before for before, after in pairwise(numbers)]
    if 0 in steps:
        first = steps.index(0)
        twice = f"{one_line(names[first])} and {one_line(names[first + 1])} have the same number"
        raise UnusableFileError(f"{twice}; give a folder with one recording")
    every = reduce(math.gcd, steps, 0) or 1
    places = tuple((number - numbers[0]) // every for number in numbers)
    if places[-1] >= MOST_FRAMES:
        raise UnusableFileError(f"frames are numbered up to {numbers[-1]:,}; mimoc reads up to {MOST_FRAMES:,}: cut it")
    missing = places[-1] + 1 - len(places)
    notes = [f"every {every} frames have a number of their own; the frame rate is that of those"] if every > 1 else []
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
        file = open_regular_file(path, MOST_FILE_BYTES, below=path.parent)
    except UnusableFileError:
        return b""
    if file is None:
        return b""
    with file:
        return file.read(_FIRST_BYTES)


def read_whole_file(path: Path) -> bytes:
    """Return the content of a file with all frames, or raise an UnusableFileError."""
    if is_regular_file(path) and path.stat().st_size > MOST_FILE_BYTES:
        raise UnusableFileError(f"is larger than {MOST_FILE_BYTES >> 20} MB, the most that mimoc reads; cut it")
    content = read_regular_file(path, MOST_FILE_BYTES)
    if content is None:
        raise UnusableFileError("cannot be read; check the path and its permissions")
    return content


def _number(stem: str) -> int | None:
    digits = re.findall(r"[0-9]+", stem)
    return int(digits[-1]) if digits and len(digits[-1]) < 16 else None

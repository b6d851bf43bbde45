"""Markers of motion capture in C3D files, as www.c3d.org describes them.

It is read here, and not by a library: of 300 files of which a few bytes were changed by chance, six ended the whole
process when ezc3d 1.7.2 read them.
"""

import math
import struct
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.bundle.regular_files import UnusableFileError, one_line
from mimoc.motion.frame_files import MAX_FRAMES, read_whole_file
from mimoc.motion.point_recording import PointRecording, ReadOptions
from mimoc.motion.timing import LENGTHS, metres_in

_BLOCK = 512
_KEY = 0x50  # Second byte of the file, and of its parameters.
_BYTE_ORDERS = {84: "<", 86: ">"}  # Byte orders of Intel and of MIPS, by the number of a processor.
_DEC = 85
_USUAL_UNIT = "mm"  # Unit of files that name none.
_DAMAGED = "is damaged, or no C3D file; export it again"
_KINDS = {-1: "S1", 1: "i1", 2: "i2", 4: "f4"}
_MAX_MARKERS = 2000


@dataclass(frozen=True, slots=True)
class _Layout:
    """Where the numbers are."""

    markers: int
    frames: int
    analog: int  # Numbers in each frame after those of the markers.
    start: int  # First byte of the first frame.
    scale: float  # Scale of integers; negative where the numbers are floats.
    rate_hz: float


def recognise(path: Path) -> bool:
    """Return whether its name ends in `.c3d`."""
    return path.suffix.lower() == ".c3d"


def read(path: Path, options: ReadOptions) -> PointRecording:
    """Return its markers, [m]; z is taken to point upwards, unless another axis is said to.

    Raises:
        UnusableFileError: If it is damaged, or of a kind that nobody writes any more.
    """
    content = read_whole_file(path)
    try:
        order, parameters = _parameters(content)
        layout = _layout(content, order, parameters)
        numbers = _numbers(content, order, layout)
    except (struct.error, IndexError, KeyError, ValueError, TypeError, OverflowError):
        raise UnusableFileError(_DAMAGED) from None
    unit = "".join(_texts(parameters, "UNITS")[:1]).strip(" \0") or _USUAL_UNIT
    metres = metres_in(unit)
    if metres is None:
        raise UnusableFileError(f"has positions in the unknown unit '{one_line(unit)}'; export it in one of {LENGTHS}")
    labels = [label.strip() for label in _texts(parameters, "LABELS")][: layout.markers]
    labels += [f"marker_{index}" for index in range(len(labels), layout.markers)]
    seen = (numbers[..., 3] >= 0) & np.isfinite(numbers[..., :3]).all(axis=-1)
    positions = np.where(seen[..., None], numbers[..., :3] * metres, np.nan)
    notes = () if options.up else ("the z axis is taken to point upwards",)
    return PointRecording(path.stem, layout.rate_hz, tuple(labels), positions, seen.astype(np.float64), notes=notes)


def _parameters(content: bytes) -> tuple[str, Mapping[str, npt.NDArray[Any]]]:
    start = (content[0] - 1) * _BLOCK
    if content[1] != _KEY or start < _BLOCK:
        raise ValueError("no C3D file")
    processor = content[start + 3]
    if processor == _DEC:
        raise UnusableFileError("has numbers of DEC computers; export it again for Intel")
    order = _BYTE_ORDERS[processor]
    end = min(start + content[start + 2] * _BLOCK, len(content))
    entries = list(_entries(content[:end], start + 4, order))
    groups = {-number: name for number, name, data in entries if number < 0}
    return order, {name: data for number, name, data in entries if number > 0 and groups.get(number) == "POINT"}


def _entries(content: bytes, at: int, order: str) -> Iterator[tuple[int, str, npt.NDArray[Any]]]:
    """Yield number of the group, name and values of each parameter; of a group itself, the number is negative."""
    while at + 2 < len(content) and content[at]:
        length = abs(struct.unpack_from("b", content, at)[0])
        (number,) = struct.unpack_from("b", content, at + 1)
        name = content[at + 2 : at + 2 + length].decode("latin-1").upper()
        at += 2 + length
        (step,) = struct.unpack_from(order + "H", content, at)
        yield number, name, np.empty(0) if number < 0 else _values(content, at + 2, order)
        if not step:
            return
        at += step


def _values(content: bytes, at: int, order: str) -> npt.NDArray[Any]:
    (size,) = struct.unpack_from("b", content, at)
    shape = tuple(content[at + 2 : at + 2 + content[at + 1]])
    kind = np.dtype(_KINDS[size] if size == -1 else order + _KINDS[size])
    if not math.prod(shape):
        return np.empty(0, kind)
    flat = np.frombuffer(content, kind, math.prod(shape), at + 2 + len(shape))
    if size != -1:
        return flat
    return flat.view(f"S{shape[0] if shape else 1}")


def _layout(content: bytes, order: str, parameters: Mapping[str, npt.NDArray[Any]]) -> _Layout:
    _, markers, analog, first, last, _, scale, block, _, rate_hz = struct.unpack_from(f"{order}5HHfHHf", content, 0)
    frames = _whole(parameters, "FRAMES", last - first + 1)
    width = (4 if scale < 0 else 2) * (4 * markers + analog)
    start = (block - 1) * _BLOCK
    held = (len(content) - start) // width if width else 0
    if frames < 0 or (frames >= 2**16 - 1 and held > frames):
        frames = held
    if start < _BLOCK or not 0 < frames <= held:
        raise ValueError("frames are missing")
    if markers > _MAX_MARKERS or frames > MAX_FRAMES:
        most = f"{_MAX_MARKERS:,} markers and {MAX_FRAMES:,} frames"
        raise UnusableFileError(f"has {markers:,} markers and {frames:,} frames; mimoc reads up to {most}: cut it")
    rates = parameters.get("RATE", np.empty(0))
    return _Layout(markers, frames, analog, start, scale, float(rates[0]) if rates.size else rate_hz)


def _numbers(content: bytes, order: str, layout: _Layout) -> npt.NDArray[np.float64]:
    """Return x, y, z and the residual of each marker, shape (t, k, 4); negative residuals are markers not seen.

    Four zeros are, too: some programs write them in place of a residual of -1.
    """
    kind = np.dtype(order + ("f4" if layout.scale < 0 else "i2"))
    width = 4 * layout.markers + layout.analog
    rows = np.frombuffer(content, kind, layout.frames * width, layout.start).reshape(layout.frames, width)
    numbers = rows[:, : 4 * layout.markers].reshape(layout.frames, layout.markers, 4).astype(np.float64)
    if layout.scale > 0:
        numbers[..., :3] *= layout.scale
    numbers[~numbers.any(axis=-1), 3] = -1
    return numbers


def _texts(parameters: Mapping[str, npt.NDArray[Any]], name: str) -> Sequence[str]:
    """Return the lines of a parameter and of those that go on with it: LABELS, LABELS2 ..."""
    names = [name, *(f"{name}{number}" for number in range(2, 10))]
    lines = [line for key in names for line in parameters.get(key, np.empty(0, "S1")).tolist()]
    return [line.decode("utf-8", "replace") for line in lines if isinstance(line, bytes)]


def _whole(parameters: Mapping[str, npt.NDArray[Any]], name: str, otherwise: int) -> int:
    values = parameters.get(name, np.empty(0))
    if values.size != 1 or values.dtype.kind not in "if":
        return otherwise
    return int(values[0]) & 0xFFFF if values.dtype.kind == "i" else int(values[0])

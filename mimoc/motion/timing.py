"""When the rows of a table were, by frame numbers or by times; frames between uneven times are interpolated."""

import math
import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import counted
from mimoc.bundle.regular_files import UnusableFileError
from mimoc.motion.frame_files import MAX_FRAMES, frame_places
from mimoc.motion.point_recording import FloatArray

_METRES = {
    1.0: "m metre meter mtr",
    0.1: "dm decimetre decimeter",
    0.01: "cm centimetre centimeter",
    0.001: "mm millimetre millimeter",
    1e-6: "um µm μm micrometre micrometer micron",
    0.0254: "in inch inche",
    0.3048: "ft foot feet",
}
_SECONDS = {
    1.0: "s sec second",
    1e-3: "ms msec milli millisec millisecond",
    1e-6: "us µs μs usec micro microsec microsecond",
    1e-9: "ns nsec nano nanosec nanosecond",
}
LENGTHS = "mm, cm, dm, m, in, ft"
_SHORTEST_PLURAL = 3  # Letters: `cms` are centimetres, `ms` are no metres.
_LENGTHS_BY_WORD, _TIMES_BY_WORD = (
    {word: size for size, words in sizes.items() for word in words.split()} for sizes in (_METRES, _SECONDS)
)


def metres_in(unit: str) -> float | None:
    """Return how many metres a unit is, such as .001 of `Millimeters` or `[mm]`; None if it is no unit of length."""
    return _find(unit, _LENGTHS_BY_WORD)


def seconds_in(unit: str) -> float | None:
    """Return how many seconds a unit is, such as .001 of `ms`; None if it is no unit of time."""
    return _find(unit, _TIMES_BY_WORD)


def _find(unit: str, sizes: dict[str, float]) -> float | None:
    word = re.sub("[^a-zµμ]", "", unit.lower())
    single = word.removesuffix("s") if len(word) >= _SHORTEST_PLURAL else word
    return sizes.get(word, sizes.get(single))


IntArray = npt.NDArray[np.intp]
FRAMES = "frame", "frames", "frame_number", "frame_id", "frame_index", "frame_idx", "frame_no", "frame_num"
_TIMES = "time", "times", "timestamp", "timestamps", "t"
_LIKELY_UNITS = "seconds", "milliseconds", "microseconds", "nanoseconds"
"""Units of times without one: the first with which the rate is one of cameras is taken."""
_RATES_HZ = 1.0, 1000.0
_MAX_FRAME_NUMBER = 2**53
_RATE_DIGITS = 9  # Digits of a frame rate that times of some digits can tell, after the point.
_JITTER = 0.1  # Range of the differences from even times, in frames, that is no more than jitter.
_ROUNDED = 1.5  # The same in units of the last digit of times, if these are a frame or less.
_WHOLE = 0.01  # Share of a digit by which times may miss whole numbers of it, due to the precision of floats.
_NEAR = 0.05  # Share of a frame within which a row is taken for that frame.
_MAX_STEP = 1.75  # Frames between two rows; more is a gap.
_MAX_TWICE = 0.1  # Share of rows that may have the time of the row before.
_WHOLE_RATE = 0.02
"""Resampled recordings have a whole number of frames a second, if their usual rate is so near to one."""


class Timing(NamedTuple):
    """When the rows of a table were."""

    rows: IntArray  # The rows that count, shape (n,).
    places: FloatArray  # Where they are on the axis of frames, whose numbers are 0, 1, 2 ..., shape (n,).
    rate_hz: float  # NaN if nothing says it.
    notes: tuple[str, ...]


class _Times(NamedTuple):
    """A column of times."""

    values: FloatArray
    second: float  # One second, in the unit of the values; 0 if they are numbers of frames.
    notes: tuple[str, ...] = ()


def timing(header: Sequence[str], numbers: FloatArray) -> Timing:
    """Return when rows were, by columns of times or frame numbers; without any, one after the other.

    Times that rise evenly, but for frames that are missing and for their last digits, are those of frames:

        time_s   0     .033  .067  .133      at 30 Hz
        places   0     1     2     4         frame 3 is a gap

    Others are those of a camera whose rate varies, as that of phones does:

        time_s   0     .033  .050  .083      at 30 Hz, for the most part
        places   0     1     1.5   2.5       frame 2 is between the last two rows

    Args:
        header: Names of the columns, in lower case.
        numbers: Shape (n, c).

    Raises:
        UnusableFileError: If times or frame numbers do not rise, or are not those of a film.
    """
    if len(numbers) > MAX_FRAMES:
        raise UnusableFileError(f"has {len(numbers):,} frames; mimoc reads up to {MAX_FRAMES:,}: cut it")
    rows = np.arange(len(numbers))
    times = _times(header, numbers)
    frames = next((numbers[:, header.index(name)] for name in FRAMES if name in header), None)
    if times and times.second and len(rows) > 1:
        return _by_times(times, frames)
    otherwise = times.values if times and not times.second else rows.astype(np.float64)
    return _by_frames(rows, otherwise if frames is None else frames)


def on_frames(values: FloatArray, places: FloatArray, *, least: bool = False) -> FloatArray:
    """Return values at frames 0, 1, 2 ..., shape (t, ...), interpolated linearly, but not over gaps, which are NaN.

    Args:
        values: Those of rows, shape (n, ...); what is between a row and one with a NaN is NaN.
        places: Where the rows are on the axis of frames, shape (n,).
        least: Take the lower of two values, and not what is between them.
    """
    before, share, is_gap = _between(places)
    earlier = values[before]
    later = values[np.minimum(before + 1, len(places) - 1)]
    shares = share.reshape(-1, *[1] * (values.ndim - 1))
    between = np.minimum(earlier, later) if least else (1 - shares) * earlier + shares * later
    made = np.where(shares == 0, earlier, between)
    made[is_gap] = np.nan
    return made


def is_of_times(cell: str) -> bool:
    """Return whether a column, whose name is in lower case, is one of times."""
    return _unit_of_times(cell) is not None


def _between(places: FloatArray) -> tuple[IntArray, FloatArray, npt.NDArray[np.bool_]]:
    """Return the row before each frame, the share of the way from it to the next row, and where gaps are."""
    frames = np.arange(np.floor(places[-1] + _NEAR) + 1)
    before = np.searchsorted(places, frames + _NEAR, side="right") - 1
    steps = np.append(np.diff(places), 1.0)[before]
    since = frames - places[before]
    is_gap = (steps > _MAX_STEP) & (np.abs(since) > _NEAR) & (np.abs(steps - since) > _NEAR)
    share = np.where(np.abs(since) <= _NEAR, 0.0, (since / steps).clip(0, 1))
    return before, share, is_gap


def _times(header: Sequence[str], numbers: FloatArray) -> _Times | None:
    units = [(index, unit) for index, cell in enumerate(header) if (unit := _unit_of_times(cell)) is not None]
    if not units:
        return None
    index, unit_s = min(units, key=lambda found: math.isnan(found[1]))
    values = numbers[:, index]
    steps = np.diff(values)
    if len(steps) and not (np.isfinite(values).all() and steps.min() >= 0 and (steps == 0).mean() <= _MAX_TWICE):
        raise UnusableFileError("has times that do not rise from row to row; check the column of times")
    if not math.isnan(unit_s) or not len(steps):
        return _Times(values, 1 / unit_s)
    usual = _usual(steps[steps > 0])
    if usual == 1 and (values == np.round(values)).all():
        return _Times(values, 0.0)
    sizes = {word: seconds_in(word) or 1.0 for word in _LIKELY_UNITS}
    likely = [word for word, size in sizes.items() if _RATES_HZ[0] <= 1 / (usual * size) <= _RATES_HZ[1]]
    word = likely[0] if likely else _LIKELY_UNITS[0]
    return _Times(values, 1 / sizes[word], () if word == _LIKELY_UNITS[0] else (f"times are taken for {word}",))


def _unit_of_times(cell: str) -> float | None:
    """Return the unit, [s], of a column by its name, such as `time_ms`: NaN if it has none; None of other columns."""
    first, *others = re.findall("[a-zµμ]+|[0-9]+", cell.replace("time_stamp", "timestamp")) or [""]
    if first in _TIMES:
        return seconds_in(others[0]) if others else math.nan
    return seconds_in(first) if first.startswith(("sec", "msec", "milli", "micro", "nano")) and not others else None


def _usual(steps: FloatArray) -> float:
    return float(np.percentile(steps, 50, method="lower"))


def _by_frames(rows: IntArray, frames: FloatArray) -> Timing:
    if not (np.abs(frames) < _MAX_FRAME_NUMBER).all() or (np.diff(frames) < 0).any():
        raise UnusableFileError("has frames without a number, or in no order; sort it by frames")
    places, notes = frame_places([int(frame) for frame in frames], [f"row {row + 2}" for row in rows])
    return Timing(rows, np.array(places, dtype=np.float64), math.nan, notes)


def _by_times(times: _Times, frames: FloatArray | None) -> Timing:
    """Return when rows were, by times that rise and, if there are, by frame numbers that agree with them."""
    (rows,) = np.nonzero(np.diff(times.values, prepend=-np.inf) > 0)
    twice = len(times.values) - len(rows)
    notes = *times.notes, *([f"left out: {counted(twice, 'row')} at the time of the row before"] if twice else [])
    since_s = (times.values[rows] - times.values[0]) / times.second
    steps_s = np.diff(since_s)
    usual_s = _usual(steps_s)
    if since_s[-1] / usual_s >= MAX_FRAMES:
        raise UnusableFileError(f"has times of more than {MAX_FRAMES:,} frames; check the column of times, or cut it")
    single_s = steps_s[np.round(steps_s / usual_s) == 1].mean()
    numbers = np.concatenate([[0], np.cumsum(np.maximum(np.round(steps_s / single_s), 1))])
    for candidate in (numbers,) if frames is None else (frames[rows], numbers):
        even = _by_frames(rows, candidate)
        period_s = float(since_s[-1] / even.places[-1])
        if np.ptp(since_s - period_s * even.places) <= _allowed(since_s, period_s):
            return even._replace(rate_hz=round(1 / period_s, _RATE_DIGITS), notes=(*notes, *even.notes))
    return _uneven(rows, since_s, 1 / usual_s, notes)


def _allowed(since_s: FloatArray, period_s: float) -> float:
    """Return the range of differences from even times that jitter and the last digit of times explain, [s]."""
    digits_s = [10.0**-digits for digits in range(_RATE_DIGITS)]
    last_s = next((size for size in digits_s if np.abs(since_s / size - np.round(since_s / size)).max() < _WHOLE), 0.0)
    return max(_JITTER * period_s, _ROUNDED * last_s if last_s <= period_s else 0.0)


def _uneven(rows: IntArray, since_s: FloatArray, rate_hz: float, notes: tuple[str, ...]) -> Timing:
    """Return when rows were between frames of the usual rate."""
    whole = max(round(rate_hz), 1)
    rate_hz = float(whole) if abs(rate_hz / whole - 1) < _WHOLE_RATE else rate_hz
    places = since_s * rate_hz
    _, share, is_gap = _between(places)
    moved = (
        f"its times are uneven: it is resampled by time, at {rate_hz:.4g} frames/s, by which {{:.0%}} of frames move"
    )
    missing = [f"{is_gap.sum():,} of {len(is_gap):,} frames are missing"] if is_gap.any() else []
    return Timing(rows, places, rate_hz, (*notes, moved.format(((share > 0) & ~is_gap).mean()), *missing))

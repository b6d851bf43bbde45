"""Which of the persons that a pose estimator sees is the infant, and where its points are."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from mimoc.base.errors import suggestion
from mimoc.bundle.regular_files import UnusableFileError, one_line
from mimoc.motion.point_recording import FloatArray


class Person(NamedTuple):
    """Somebody in a frame."""

    identity: str
    """What says that it is the same person in other frames; empty if nothing does."""
    numbers: Sequence[float]
    """x, y and confidence of each point, one point after the other."""


class Frame(NamedTuple):
    """Everybody in a frame."""

    place: int
    """Its index in time."""
    where: str
    """The file that it is in, or its number, for messages."""
    persons: Sequence[Person]


def place_points(frames: Sequence[Frame], infant: int | str | None, points: int) -> tuple[FloatArray, FloatArray, str]:
    """Return where the points of the infant are in each frame, and how surely.

    Args:
        frames: In the order of time; not all need be there.
        infant: The identity of the infant or, where persons have none, its number in the first frame with several, from
            0. None is the person who is the largest, over all frames.
        points: Number of points k.

    Returns:
        Positions, shape (t, k, 2), [px], NaN where a point is not seen; confidence, shape (t, k); and what had to be
        assumed, if anything.

    Raises:
        UnusableFileError: If there is no such infant, nobody at all, or numbers are damaged.
    """
    chosen, note = _choose(frames, None if infant is None else str(infant), 3 * points)
    if not chosen:
        raise UnusableFileError("has nobody in any frame; check that the pose estimator sees the infant")
    rows = _rows([(frame.where, person) for frame, person in chosen], 3 * points).reshape(-1, points, 3)
    numbers = np.full((frames[-1].place + 1, points, 3), np.nan)
    numbers[[frame.place for frame, _ in chosen]] = rows
    confidence = np.nan_to_num(numbers[..., 2], nan=0.0, posinf=0.0, neginf=0.0)
    seen = (confidence > 0) & np.isfinite(numbers[..., :2]).all(axis=-1)
    return np.where(seen[..., None], numbers[..., :2], np.nan), np.where(seen, confidence.clip(0, 1), 0.0), note


def _choose(frames: Sequence[Frame], infant: str | None, width: int) -> tuple[Sequence[tuple[Frame, Person]], str]:
    """Return the frames in which the infant is, with it, and what had to be assumed."""
    if any(person.identity for frame in frames for person in frame.persons):
        return _by_identity(frames, infant, width)
    if all(len(frame.persons) <= 1 for frame in frames):
        if infant not in (None, "0"):
            raise UnusableFileError(f"has one person in each frame, and no infant '{one_line(infant)}'; leave it out")
        return [(frame, frame.persons[0]) for frame in frames if frame.persons], ""
    return _by_nearness(frames, infant, width)


def _by_identity(frames: Sequence[Frame], infant: str | None, width: int) -> tuple[Sequence[tuple[Frame, Person]], str]:
    sizes: dict[str, float] = {}
    for frame in frames:
        for person in frame.persons:
            sizes[person.identity] = sizes.get(person.identity, 0.0) + _size(_rows([(frame.where, person)], width)[0])
    if infant is not None and infant not in sizes:
        known = suggestion(infant, [one_line(identity) for identity in sizes])
        raise UnusableFileError(f"has no person '{one_line(infant)}'; {known}")
    largest = infant if infant is not None else max(sizes, key=sizes.__getitem__)
    chosen = [(frame, person) for frame in frames for person in frame.persons if person.identity == largest]
    if len({frame.place for frame, _ in chosen}) < len(chosen):
        raise UnusableFileError(f"has person '{one_line(largest)}' twice in a frame; track persons again")
    is_guess = infant is None and len(sizes) > 1
    return chosen, f"the infant is taken to be person '{one_line(largest)}', the largest" if is_guess else ""


def _by_nearness(frames: Sequence[Frame], infant: str | None, width: int) -> tuple[Sequence[tuple[Frame, Person]], str]:
    """Follow the infant from frame to frame: it is whoever is nearest to where it was."""
    first = next(frame for frame in frames if len(frame.persons) > 1)
    sizes = [_size(row) for row in _rows([(first.where, person) for person in first.persons], width)]
    if infant is not None and not (infant.isdecimal() and int(infant) < len(sizes)):
        most = len(sizes) - 1
        raise UnusableFileError(f"has no person '{one_line(infant)}' in {first.where}; give a number from 0 to {most}")
    number = int(infant) if infant is not None else int(np.argmax(sizes))
    start = frames.index(first)
    chosen = [(first, first.persons[number])]
    chosen += _followed(frames[start + 1 :], chosen[0], width)
    chosen[:0] = reversed(_followed(frames[:start][::-1], chosen[0], width))
    who = "the largest" if infant is None else f"number {number}"
    return (
        chosen,
        f"the infant is taken to be {who} of {len(sizes)} in {first.where}, and whoever is nearest after that",
    )


def _followed(frames: Iterable[Frame], start: tuple[Frame, Person], width: int) -> list[tuple[Frame, Person]]:
    last = _rows([(start[0].where, start[1])], width)[0]
    followed = []
    for frame in frames:
        if frame.persons:
            rows = _rows([(frame.where, person) for person in frame.persons], width)
            nearest = int(np.argmin([_distance(row, last) for row in rows])) if len(rows) > 1 else 0
            last = rows[nearest]
            followed.append((frame, frame.persons[nearest]))
    return followed


def _seen(row: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the points of a person, shape (k, 2), and which are seen."""
    numbers = row.reshape(-1, 3)
    return numbers[:, :2], (numbers[:, 2] > 0) & np.isfinite(numbers).all(axis=1)


def _size(row: FloatArray) -> float:
    """Return the diagonal of the box around a person, [px]."""
    points, seen = _seen(row)
    return float(np.linalg.norm(np.ptp(points[seen], axis=0))) if seen.any() else 0.0


def _distance(one: FloatArray, other: FloatArray) -> float:
    (points, seen), (others, also_seen) = _seen(one), _seen(other)
    both = seen & also_seen
    return float(np.linalg.norm(points[both] - others[both], axis=1).mean()) if both.any() else np.inf


def _rows(persons: Sequence[tuple[str, Person]], width: int) -> FloatArray:
    """Return the numbers of persons, shape (n, width), or raise an UnusableFileError that says which are none."""
    try:
        rows = np.array([person.numbers for _, person in persons], dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        rows = np.empty(0)
    if rows.shape == (len(persons), width):
        return rows
    if len(persons) > 1:
        for person in persons:
            _rows([person], width)
    raise UnusableFileError(f"{persons[0][0]}: the numbers of points are damaged, not {width}; export it again")

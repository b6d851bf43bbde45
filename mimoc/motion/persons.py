"""Which of the persons that a pose estimator sees is the infant, and where its points are."""

import math
from array import array
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple, cast

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import counted, suggestion
from mimoc.bundle.regular_files import UnusableFileError, one_line
from mimoc.motion.point_recording import FloatArray

Indices = npt.NDArray[np.intp]


class Person(NamedTuple):
    """Somebody in a frame."""

    identity: str
    """What says that it is the same person in other frames; empty if nothing does."""
    numbers: "array[float]"
    """x, y and confidence of each point, one point after the other."""


def person(identity: str, numbers: Sequence[float | None], where: str) -> Person:
    """Return somebody by the numbers of a file, of which nothing but numbers is kept; None is NaN.

    Raises:
        UnusableFileError: If they are no numbers: *where* they stand, and that.
    """
    try:
        try:
            return Person(identity, array("d", cast(Sequence[float], numbers)))  # Few have a None.
        except TypeError:
            return Person(identity, array("d", [math.nan if number is None else number for number in numbers]))
    except (TypeError, OverflowError):
        raise UnusableFileError(f"{one_line(where)}: points are not numbers; export it again") from None


class Frame(NamedTuple):
    """Everybody in a frame."""

    place: int
    """Its index in time."""
    where: str
    """The file that it is in, or its number, for messages."""
    persons: Sequence[Person]


class _People(NamedTuple):
    """All persons in all frames, n of them, in the order of time."""

    identities: Sequence[str]
    where: Sequence[str]
    places: Indices
    """Index of the frame of each, shape (n,)."""
    points: FloatArray
    """Shape (n, k, 2), [px]; NaN where a point is not seen."""
    sizes: FloatArray
    """Diagonals of the boxes around them, shape (n,), [px]."""


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
    several = [(frame, person) for frame in frames for person in frame.persons]
    if not several:
        raise UnusableFileError("has nobody in any frame; check that the pose estimator sees the infant")
    numbers = _rows([(frame.where, person) for frame, person in several], 3 * points).reshape(-1, points, 3)
    seen = (numbers[..., 2] > 0) & np.isfinite(numbers).all(axis=-1)
    placed = np.where(seen[..., None], numbers[..., :2], np.nan)
    bounded = placed.clip(-1e9, 1e9)
    box = np.fmax.reduce(bounded, axis=1) - np.fmin.reduce(bounded, axis=1)
    people = _People(
        [person.identity for _, person in several],
        [frame.where for frame, _ in several],
        np.array([frame.place for frame, _ in several]),
        placed,
        np.linalg.norm(np.nan_to_num(box), axis=-1),
    )
    chosen, note = _choose(people, None if infant is None else str(infant))
    shape = frames[-1].place + 1, points
    positions, confidence = np.full((*shape, 2), np.nan), np.zeros(shape)
    positions[people.places[chosen]] = placed[chosen]
    confidence[people.places[chosen]] = np.where(seen, numbers[..., 2], 0.0)[chosen].clip(0, 1)
    return positions, confidence, note


def _choose(people: _People, infant: str | None) -> tuple[Indices, str]:
    """Return where among people the infant is, at most once in a frame, and what had to be assumed."""
    if any(people.identities):
        return _by_identity(people, infant)
    starts = np.unique(people.places, return_index=True)[1]
    if len(starts) < len(people.places):
        return _by_nearness(people, infant, [*starts.tolist(), len(people.places)])
    if infant not in (None, "0"):
        raise UnusableFileError(f"has one person in each frame, and no infant '{one_line(str(infant))}'; leave it out")
    return starts, ""


def _by_identity(people: _People, infant: str | None) -> tuple[Indices, str]:
    identities = np.array(people.identities, dtype=object)
    names, which = np.unique(identities.astype(str), return_inverse=True)
    known = [str(name) for name in names]
    if infant is not None and infant not in known:
        near = suggestion(infant, [one_line(name) for name in known])
        raise UnusableFileError(f"has no person '{one_line(infant)}'; {near}")
    sizes = np.bincount(which, people.sizes)
    number = known.index(infant) if infant is not None else int(np.argmax(sizes))
    (chosen,) = np.nonzero(which == number)
    name = one_line(known[number])
    if len(np.unique(people.places[chosen])) < len(chosen):
        raise UnusableFileError(f"has person '{name}' twice in a frame; track persons again")
    is_guess = infant is None and len(known) > 1
    others = counted(len(known), "person")
    return chosen, f"the infant is taken to be '{name}', the largest of {others}" if is_guess else ""


def _by_nearness(people: _People, infant: str | None, starts: Sequence[int]) -> tuple[Indices, str]:
    """Follow the infant from frame to frame: it is whoever is nearest to where it was.

    Args:
        people: In the order of time.
        infant: Its number in the first frame with several.
        starts: Where each frame begins among them, and where the last one ends.
    """
    spans = list(pairwise(starts))
    first = next(index for index, (start, stop) in enumerate(spans) if stop - start > 1)
    start, stop = spans[first]
    number = int(np.argmax(people.sizes[start:stop])) if infant is None else int(infant) if infant.isdecimal() else -1
    if not 0 <= number < stop - start:
        most = stop - start - 1
        raise UnusableFileError(f"has no person '{one_line(str(infant))}' in {people.where[start]}; give 0 to {most}")
    chosen = start + number
    before = _followed(people.points, spans[:first][::-1], chosen)[::-1]
    after = _followed(people.points, spans[first + 1 :], chosen)
    who = "the largest" if infant is None else f"number {number}"
    note = f"the infant is taken to be {who} of {stop - start} persons in {one_line(people.where[start])}"
    return np.array([*before, chosen, *after]), f"{note}, and is followed from there"


def _followed(points: FloatArray, spans: Sequence[tuple[int, int]], start: int) -> list[int]:
    """Return who of each frame is nearest to whom it was in the frame before; points may have changed meanwhile."""
    places = points.reshape(len(points), -1)
    last, followed = places[start], []
    for first, stop in spans:
        nearest = first
        if stop - first > 1:
            squares = np.square(places[first:stop] - last)
            both = np.isfinite(squares)
            shared, totals = both.sum(axis=1), squares.sum(axis=1, where=both)
            nearest += int(np.argmin(np.where(shared > 0, totals / np.maximum(shared, 1), np.inf)))
        last = np.where(np.isfinite(places[nearest]), places[nearest], last)
        followed.append(nearest)
    return followed


def _rows(persons: Sequence[tuple[str, Person]], width: int) -> FloatArray:
    """Return the numbers of persons, shape (n, width), or raise an UnusableFileError that says who has others."""
    wrong = next((where for where, person in persons if len(person.numbers) != width), None)
    if wrong is not None:
        raise UnusableFileError(f"{one_line(wrong)}: points are not {width} numbers; export it again")
    return np.frombuffer(b"".join([person.numbers for _, person in persons])).reshape(-1, width)

"""Which of the persons that a pose estimator sees is the infant, and where its points are."""

import math
from array import array
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple, cast

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import counted, suggestion
from mimoc.bundle.regular_files import UnusableFileError, first_of, one_line
from mimoc.motion.options import ReadOptions
from mimoc.motion.point_recording import FloatArray
from mimoc.motion.tracks import Detections, Indices, Tracks, find_tracks

_RATE_HZ = 25.0
"""Frames per second by which persons are followed before anybody says it."""
_LONG = 0.5
"""Share of the frames of whoever is seen for longest, from which on somebody may be the infant."""
_ALIKE = 0.6
"""How many times as large as the infant somebody else must be to be taken for it by others."""
_SELDOM = 0.1
"""Share of the infant's frames below which somebody else is not doubted to be it."""
_SHARED_BY_SEVERAL = 0.5
"""Share of its frames in which several persons have one identity, from which on it says nothing."""
_SHOWN = 6
"""Identities in a note."""


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
    """Everybody of whom a point is surely seen, n in all, in the order of time."""

    identities: npt.NDArray[np.str_]
    """What a tracker calls each, shape (n,); empty for nothing."""
    numbers: Indices
    """Which person of its frame each is, from 0, shape (n,)."""
    places: Indices
    """Index of the frame of each, shape (n,)."""
    sizes: FloatArray
    """Diagonals of the boxes around them, shape (n,), [px]."""
    tracks: Tracks

    def size(self, track: int) -> float:
        """Return the median size of a person, [px]."""
        return float(np.median(self.sizes[self.tracks.numbers == track]))


def identity(value: object) -> str:
    """Return what a tracker calls a person: `1` of 1, 1.0, [1] or "1"; nothing of -1, which is not tracked, or none."""
    while isinstance(value, list) and value:
        value = value[0]
    if isinstance(value, (int, float)):
        return f"{value:.15g}" if value >= 0 else ""
    return value if isinstance(value, str) and value != "-1" else ""


def place_points(
    frames: Sequence[Frame], options: ReadOptions, points: int, least: float
) -> tuple[FloatArray, FloatArray, tuple[str, ...]]:
    """Return where the points of the infant are in each frame, and how surely.

    Args:
        frames: In the order of time; not all need be there.
        options: Its `infant` is its identity or, where persons have none, its number in the first frame with several,
            from 0; None is the largest of those who are there for long.
        points: Number of points k.
        least: Confidence below which points do not help to find it.

    Returns:
        Positions, shape (t, k, 2), [px], NaN where a point is not seen; confidence, shape (t, k), also of points below
        the least; and what had to be assumed.

    Raises:
        UnusableFileError: If there is no such infant, nobody at all, or numbers are damaged.
    """
    several = [(frame, number, who) for frame in frames for number, who in enumerate(frame.persons)]
    if not several:
        raise UnusableFileError("has nobody in any frame; check that the pose estimator sees the infant")
    numbers = _rows([(frame.where, who) for frame, _, who in several], 3 * points).reshape(-1, points, 3)
    seen = np.isfinite(numbers).all(axis=-1) & (numbers[..., 2] > 0) & numbers[..., :2].any(axis=-1)
    sure = seen & (numbers[..., 2] >= least)
    there = np.flatnonzero(sure.any(axis=1))
    if not len(there):
        raise UnusableFileError(f"has no point with a confidence of {least:g} or more; give a lower one: min_score=0")
    placed = np.where(sure[..., None], numbers[..., :2].clip(-1e9, 1e9), np.nan)[there]
    places = np.array([frame.place for frame, _, _ in several])[there]
    identities = _told_apart(np.array([who.identity for _, _, who in several])[there], places)
    codes = np.where(identities == "", -1, np.unique(identities, return_inverse=True)[1])
    box = np.fmax.reduce(placed, axis=1) - np.fmin.reduce(placed, axis=1)
    people = _People(
        identities,
        np.array([number for _, number, _ in several])[there],
        places,
        np.linalg.norm(box, axis=-1),
        find_tracks(Detections(places, placed, codes, options.rate_hz or _RATE_HZ)),
    )
    track, notes = _choose(people, frames, None if options.infant is None else identity(options.infant))
    mine = people.tracks.numbers == track
    chosen, at = there[mine], places[mine]
    shape = frames[-1].place + 1, points
    positions, confidence = np.full((*shape, 2), np.nan), np.zeros(shape)
    positions[at] = np.where(seen[..., None], numbers[..., :2], np.nan)[chosen]
    confidence[at] = np.where(seen, numbers[..., 2], 0.0)[chosen].clip(0, 1)
    return positions, confidence, (*notes, *_account(people, track))


def _told_apart(identities: npt.NDArray[np.str_], places: Indices) -> npt.NDArray[np.str_]:
    """Return identities without those that several persons in a frame have, as AlphaPose's 0 if it does not track."""
    told = identities.copy()
    for name in np.unique(identities):
        times = np.unique(places[identities == name], return_counts=True)[1]
        if (times > 1).mean() > _SHARED_BY_SEVERAL:
            told[identities == name] = ""
    return told


def _choose(people: _People, frames: Sequence[Frame], infant: str | None) -> tuple[int, tuple[str, ...]]:
    """Return the track of the infant, and what had to be assumed."""
    numbers = people.tracks.numbers
    if infant is None:
        track = _largest(people)
        return track, (_guess(people, frames, track),) if (numbers != track).any() else ()
    if known := _names(people.identities):
        if infant not in known:
            near = suggestion(infant, [one_line(name) for name in known])
            raise UnusableFileError(f"has no person '{one_line(infant)}'; {near}")
        return int(np.argmax(np.bincount(numbers[people.identities == infant]))), ()
    first = next((frame for frame in frames if len(frame.persons) > 1), None)
    if first is None:
        if infant != "0":
            raise UnusableFileError(f"has one person in each frame, and no infant '{one_line(infant)}'; leave it out")
        return _largest(people), ()
    meant = (people.places == first.place) & (people.numbers == (int(infant) if infant.isdecimal() else -1))
    if not meant.any():
        most, where = len(first.persons) - 1, one_line(first.where)
        raise UnusableFileError(f"has no person '{one_line(infant)}' in {where}; give 0 to {most}")
    who = f"number {infant} of {len(first.persons)} persons in {one_line(first.where)}"
    return int(numbers[meant][0]), (f"the infant is taken to be {who}, and is followed from there",)


def _names(identities: npt.NDArray[np.str_]) -> list[str]:
    return [name for name in np.unique(identities).tolist() if name]


def _largest(people: _People) -> int:
    """Return the track of the largest of those who are seen for long and, where some are tracked, of these."""
    named = people.identities != ""
    tracks, times = np.unique(people.tracks.numbers[named if named.any() else ...], return_counts=True)
    return max(tracks[times >= _LONG * times.max()].tolist(), key=people.size)


def _guess(people: _People, frames: Sequence[Frame], track: int) -> str:
    """Return who is taken for the infant, and in what share of frames that is doubtful."""
    mine = people.tracks.numbers == track
    known = _names(people.identities)
    beside = {*people.places[mine].tolist()}
    first = next((frame for frame in frames if len(frame.persons) > 1 and frame.place in beside), None)
    if len(known) == 1:
        guess = f"the infant is taken to be '{one_line(known[0])}', the only person who is tracked"
    elif known:
        who = f"'{one_line(_name_of(people, mine))}', the largest of {counted(len(known), 'person')}"
        guess = f"the infant is taken to be {who}"
    elif first:
        who = f"the largest of {len(first.persons)} persons in {one_line(first.where)}"
        guess = f"the infant is taken to be {who}, and is followed from there"
    else:
        guess = "the infant is taken to be who is seen for longest, or the largest of those"
    tracks, times = np.unique(people.tracks.numbers[~mine], return_counts=True)
    least = _ALIKE * people.size(track)
    alike = [one for one in tracks[times >= _SELDOM * mine.sum()].tolist() if people.size(one) >= least]
    if not alike:
        return guess
    share = len({*people.places[np.isin(people.tracks.numbers, alike)].tolist()}) / len({*people.places.tolist()})
    return (
        f"{guess}; this is doubtful in {share:.0%} of frames, where others are about as large: say which is the infant"
    )


def _name_of(people: _People, mine: npt.NDArray[np.bool_]) -> str:
    """Return the identity that a person has most of the time; empty for none."""
    names, times = np.unique(people.identities[mine & (people.identities != "")], return_counts=True)
    return str(names[np.argmax(times)]) if len(names) else ""


def _account(people: _People, track: int) -> Iterator[str]:
    """Yield what is to be said of a person who was followed."""
    mine = people.tracks.numbers == track
    names = [name for name, _ in groupby(people.identities[mine & (people.identities != "")].tolist())]
    if len(names) > 1:
        order = first_of([one_line(name) for name in names], _SHOWN)
        yield f"the infant's track goes on under another ID {counted(len(names) - 1, 'time')}, and is joined: {order}"
    if name := _name_of(people, mine):
        elsewhere = (people.identities == name) & ~mine
        if elsewhere.any():
            share = elsewhere.sum() / (people.identities == name).sum()
            yield f"'{one_line(name)}' is not where the infant can be in {share:.0%} of its frames, which are left out"
    frames = len({*people.places.tolist()})
    if lost := frames - int(mine.sum()):
        why = "too far from where it was, or of another size"
        yield f"in {lost:,} of {frames:,} frames nobody who is seen can be the infant, being {why}"
    if share := people.tracks.doubtful(track).sum() / mine.sum():
        yield f"who the infant is is doubtful in {share:.1%} of its frames, where another is nearly as close"


def _rows(persons: Sequence[tuple[str, Person]], width: int) -> FloatArray:
    """Return the numbers of persons, shape (n, width), or raise an UnusableFileError that says who has others."""
    wrong = next((where for where, person in persons if len(person.numbers) != width), None)
    if wrong is not None:
        raise UnusableFileError(f"{one_line(wrong)}: points are not {width} numbers; export it again")
    return np.frombuffer(b"".join([person.numbers for _, person in persons])).reshape(-1, width)

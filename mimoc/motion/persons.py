"""Which of the persons that a pose estimator sees is the infant, and where its points are."""

import math
from array import array
from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import NamedTuple, cast

import numpy as np

from mimoc.base.errors import counted, suggestion
from mimoc.bundle.regular_files import UnusableFileError, first_of, one_line
from mimoc.motion.checks import RATES_HZ
from mimoc.motion.point_recording import FloatArray, ReadOptions
from mimoc.motion.tracks import Detections, Indices, Tracks, find_tracks, seen_twice

_RATE_HZ = 25.0
"""Frames per second by which persons are followed where nobody says it, or what no camera takes, which is refused."""
_LONG = 0.5  # Share of the frames of whoever is seen for longest, from which on somebody may be the infant.
_ALIKE = 0.6  # How many times as large as the infant somebody else must be to be taken for it by others.
_SELDOM = 0.1  # Share of the infant's frames below which somebody else is not doubted to be it.
_LARGEST = 2**63  # More than any number of a person.
_MAX_LISTED = 6


class Person(NamedTuple):
    """Somebody in a frame."""

    identity: str  # What says that it is the same person in other frames; empty if nothing does.
    numbers: "array[float]"  # x, y and confidence of each point, one point after the other.


def person(identity: str, numbers: Sequence[float | None], where: str) -> Person:
    """Return somebody by the numbers of a file, None as NaN, or an UnusableFileError with *where* they stand."""
    try:
        try:
            return Person(identity, array("d", cast(Sequence[float], numbers)))  # Few have a None.
        except TypeError:
            return Person(identity, array("d", [math.nan if number is None else number for number in numbers]))
    except (TypeError, OverflowError):
        raise UnusableFileError(f"{one_line(where)}: points are not numbers; export it again") from None


class Frame(NamedTuple):
    """Everybody in a frame."""

    place: int  # Its index in time.
    where: str  # The file that it is in, or its number, for messages.
    persons: Sequence[Person]


class _People(NamedTuple):
    """Everybody of whom a point is surely seen, n in all, in the order of time."""

    names: Sequence[str]  # What a tracker calls persons.
    identities: Indices  # Index of the name of each, shape (n,); -1 for none.
    numbers: Indices  # Which person of its frame each is, from 0, shape (n,).
    places: Indices  # Index of the frame of each, shape (n,).
    sizes: FloatArray  # Diagonals of the boxes around them, shape (n,), [px].
    tracks: Tracks

    @property
    def frames(self) -> int:
        """Number of frames in which anybody is."""
        return len(np.unique(self.places))

    def first_of_several(self, frames: Sequence[Frame], places: Indices) -> Frame | None:
        """Return the first frame with several persons among those at some places; None if there is none."""
        several = np.intersect1d(np.flatnonzero(np.bincount(self.places) > 1), places)
        return next((frame for frame in frames if frame.place == several[0]), None) if len(several) else None

    @property
    def known(self) -> list[str]:
        """Names by which persons can be told apart."""
        return [self.names[int(index)] for index in np.unique(self.identities) if index >= 0]

    @property
    def track_sizes(self) -> FloatArray:
        """Mean size of the person in each track, by its number, [px]."""
        numbers = self.tracks.numbers
        return np.bincount(numbers, self.sizes) / np.maximum(np.bincount(numbers), 1)

    def identity_of(self, track: int) -> int:
        """Return the identity that a person has most of the time; -1 for none."""
        identities = self.identities[(self.tracks.numbers == track) & (self.identities >= 0)]
        return int(np.argmax(np.bincount(identities))) if len(identities) else -1


def identity(value: object) -> str:
    """Return what a tracker calls a person: `1` of 1, 1.0, [1] or "1"; nothing of -1, which is not tracked, or none."""
    while isinstance(value, list) and value:
        value = value[0]
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, (int, float)):
        return str(value) if 0 <= value < _LARGEST else ""
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
    everybody = [(frame, number, who) for frame in frames for number, who in enumerate(frame.persons)]
    if not everybody:
        raise UnusableFileError("has nobody in any frame; check that the pose estimator sees the infant")
    numbers = _rows([(frame.where, who) for frame, _, who in everybody], 3 * points).reshape(-1, points, 3)
    seen = np.isfinite(numbers).all(axis=-1) & (numbers[..., 2] > 0) & numbers[..., :2].any(axis=-1)
    sure = seen & (numbers[..., 2] >= least)
    there = np.flatnonzero(sure.any(axis=1))
    if not len(there):
        raise UnusableFileError(f"has no point with a confidence of {least:g} or more; give a lower one: min_score=0")
    placed = np.where(sure[..., None], numbers[..., :2].clip(-1e9, 1e9), np.nan)
    places = np.array([frame.place for frame, _, _ in everybody])
    names = sorted({who.identity for _, _, who in everybody} - {""})
    index = {name: number for number, name in enumerate(names)}
    identities = _unique_identities(np.array([index.get(who.identity, -1) for _, _, who in everybody]), places)
    said_hz = options.rate_hz or _RATE_HZ
    rate_hz = said_hz if RATES_HZ[0] <= said_hz <= RATES_HZ[1] else _RATE_HZ
    detections = Detections(places, placed, identities, rate_hz)
    there = there[~seen_twice(_chosen(detections, there))]
    kept = _chosen(detections, there)
    box = np.fmax.reduce(kept.points, axis=1) - np.fmin.reduce(kept.points, axis=1)
    people = _People(
        names,
        kept.identities,
        np.array([number for _, number, _ in everybody])[there],
        kept.places,
        np.linalg.norm(box, axis=-1),
        find_tracks(kept),
    )
    infant = None if options.infant is None else identity(options.infant) or str(options.infant)
    track, notes = _choose(people, frames, infant)
    mine = people.tracks.numbers == track
    chosen = there[mine]
    at = people.places[mine]
    shape = frames[-1].place + 1, points
    positions = np.full((*shape, 2), np.nan)
    confidence = np.zeros(shape)
    positions[at] = np.where(seen[..., None], numbers[..., :2], np.nan)[chosen]
    confidence[at] = np.where(seen, numbers[..., 2], 0.0)[chosen].clip(0, 1)
    return positions, confidence, (*notes, *_account(people, track))


def _chosen(detections: Detections, rows: Indices) -> Detections:
    """Return the detections at some indices."""
    places, points, identities, rate_hz = detections
    return Detections(places[rows], points[rows], identities[rows], rate_hz)


def _unique_identities(identities: Indices, places: Indices) -> Indices:
    """Return identities without those that several persons in a frame have, as AlphaPose's 0 if it does not track."""
    named = identities >= 0
    frames = int(places.max()) + 1
    pairs, times = np.unique(identities[named] * frames + places[named], return_counts=True)
    # One more entry, so that -1 is a valid index even if nobody has an identity.
    most = int(identities.max()) + 2
    alone, together = (np.bincount(pairs[chosen] // frames, minlength=most) for chosen in (times == 1, times > 1))
    return np.where(named & (alone >= together)[identities], identities, -1)


def _choose(people: _People, frames: Sequence[Frame], infant: str | None) -> tuple[int, tuple[str, ...]]:
    numbers = people.tracks.numbers
    if infant is None:
        track = _largest(people)
        return track, (_guess(people, frames, track),) if (numbers != track).any() else ()
    if known := people.known:
        if infant not in known:
            near = suggestion(infant, [one_line(name) for name in known])
            raise UnusableFileError(f"has no person '{one_line(infant)}'; {near}")
        return int(np.argmax(np.bincount(numbers[people.identities == people.names.index(infant)]))), ()
    first = people.first_of_several(frames, people.places)
    if first is None:
        if infant != "0":
            raise UnusableFileError(f"has one person in each frame, and no infant '{one_line(infant)}'; leave it out")
        return _largest(people), ()
    meant = (people.places == first.place) & (people.numbers == (int(infant) if infant.isdecimal() else -1))
    if not meant.any():
        where = one_line(first.where)
        raise UnusableFileError(f"has no person '{one_line(infant)}' in {where}; give 0 to {len(first.persons) - 1}")
    who = f"number {infant} of {len(first.persons)} persons in {one_line(first.where)}"
    return int(numbers[meant][0]), (f"the infant is taken to be {who}, and is followed from there",)


def _largest(people: _People) -> int:
    """Return the track of the largest of those who are seen for long and, where some are tracked, of these."""
    named = people.identities >= 0
    eligible = named if named.any() else np.ones_like(named)
    times = np.bincount(people.tracks.numbers[eligible])
    return int(np.argmax(np.where(times >= _LONG * times.max(), people.track_sizes[: len(times)], 0.0)))


def _guess(people: _People, frames: Sequence[Frame], track: int) -> str:
    """Return who is taken for the infant, and in what share of frames that is doubtful."""
    numbers = people.tracks.numbers
    name = people.identity_of(track)
    first = people.first_of_several(frames, people.places[numbers == track])
    if name >= 0:
        tracked = len(np.unique(numbers[people.identities >= 0]))
        why = f"the largest of {counted(tracked, 'person')}" if tracked > 1 else "the only person who is tracked"
        guess = f"the infant is taken to be '{one_line(people.names[name])}', {why}"
    elif first:
        who = f"the largest of {len(first.persons)} persons in {one_line(first.where)}"
        guess = f"the infant is taken to be {who}, and is followed from there"
    else:
        guess = "the infant is taken to be who is seen for longest, or the largest of those"
    times = np.bincount(numbers)
    sizes = people.track_sizes
    alike = (times >= _SELDOM * times[track]) & (sizes >= _ALIKE * sizes[track])
    alike[track] = False
    if not alike.any():
        return guess
    share = len(np.unique(people.places[alike[numbers]])) / people.frames
    return (
        f"{guess}; this is doubtful in {share:.0%} of frames, where others are about as large: say which is the infant"
    )


def _account(people: _People, track: int) -> Iterator[str]:
    """Yield what is to be said of a person who was followed."""
    mine = people.tracks.numbers == track
    names = [one_line(people.names[int(index)]) for index in people.identities[mine] if index >= 0]
    names = [name for name, _ in groupby(names)]
    if len(names) > 1:
        joined = f"{counted(len(names) - 1, 'time')}, and is joined: {first_of(names, _MAX_LISTED)}"
        yield f"the infant's track goes on under another ID {joined}"
    if (who := people.identity_of(track)) >= 0:
        elsewhere = (people.identities == who) & ~mine
        if elsewhere.any():
            share = elsewhere.sum() / (people.identities == who).sum()
            where = f"is not where the infant can be in {share:.0%} of its frames, which are left out"
            yield f"'{one_line(people.names[who])}' {where}"
    if lost := people.frames - int(mine.sum()):
        why = "too far from where it was, or of another size"
        yield f"in {lost:,} of {people.frames:,} frames nobody who is seen can be the infant, being {why}"
    if share := people.tracks.doubtful(track).sum() / mine.sum():
        yield f"who the infant is is doubtful in {share:.1%} of its frames, where another is nearly as close"


def _rows(persons: Sequence[tuple[str, Person]], width: int) -> FloatArray:
    """Return the numbers of persons, shape (n, width), or raise an UnusableFileError that says who has others."""
    wrong = next((where for where, person in persons if len(person.numbers) != width), None)
    if wrong is not None:
        raise UnusableFileError(f"{one_line(wrong)}: points are not {width} numbers; export it again")
    return np.frombuffer(b"".join([person.numbers for _, person in persons])).reshape(-1, width)

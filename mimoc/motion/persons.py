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
from mimoc.motion.checks import RATES_HZ
from mimoc.motion.point_recording import FloatArray, ReadOptions

Indices = npt.NDArray[np.intp]

_AT_ONCE = 0.3
"""What may change from a frame to the next at any frame rate, in radii. Kicking infants of three months moved .1 at 25
frames a second, and .44 within a second."""
_SPEED = 4.0  # Radii a second, the radius of an infant being about .17 m: .7 m/s, as when it is picked up.
_FARTHEST = 1.5  # Radii, about .25 m. Adults who sit beside an infant are 2 away, and more.
_GROWS = 1.45  # Ratio of radii. Those of kicking infants changed by up to 1.3 within a second, as legs are drawn up.
_WILD = 2.5  # Median distances from the middle of a body from which on a point does not make it larger.
_PER_SECOND = 0.5  # Cost of a gap, in radii a second.
_SURE, _SURE_PER_SECOND = 0.15, 1.5
"""Cost, and more of it a second, up to which a link to the next frame is taken before those over gaps are looked at."""
_KNOWN = 1.0  # What two detections of one identity cost less, and two of different ones more.
_MIN_SHARED = 3  # Points that two detections must both have for a comparison point by point.
_MIN_SIZE = 0.4  # Radii over which these points must be spread to tell the size of a body; those of a face do not.
_AS_GOOD = 2.0, 0.2  # Another link is nearly as good if it costs up to twice as much, and .2 more.
_NEXT = 30  # Tracks that begin next after the end of one, of which one may go on with it.
_MAX_OVER_GAPS = 500_000  # Pairs that are compared in each round of joining.
_MAX_ROUNDS = 20  # Of joining over gaps: most films need two or three.
_MAX_PAIRS = 4_000_000
"""In the same or consecutive frames: 2.4 hours at 30 frames a second with four persons, or ten minutes with fifteen."""
_REMEMBERED_S, _REMEMBERED = 0.15, 4
"""Seconds, and at most so many further frames, before and after a gap that are compared across it, by their medians."""
_CHUNK = 20_000  # Pairs that are compared at once, which bounds memory.


class Detections(NamedTuple):
    """Everybody in each frame, n in all, in the order of time."""

    places: Indices  # Index of the frame of each, shape (n,).
    points: FloatArray  # Shape (n, k, 2), [px]; NaN where a point is not seen; of each, at least one is.
    identities: Indices  # Number of the identity that a tracker gave, shape (n,); -1 for none.
    rate_hz: float


class Links(NamedTuple):
    """Pairs of detections, the second of each later."""

    before: Indices
    after: Indices
    costs: FloatArray


class Tracks(NamedTuple):
    """Detections by person."""

    numbers: Indices  # Which track each detection belongs to, shape (n,).
    previous: Indices  # Index of the one before it in its track, shape (n,); -1 for none.
    possible: Links  # All links that are near enough, with those that were taken.

    def doubtful(self, track: int) -> npt.NDArray[np.bool_]:
        """Return which detections, shape (n,), of a track might nearly as well be somebody else."""
        mine = self.numbers == track
        linked = np.flatnonzero(mine & (self.previous >= 0))
        following = np.full(len(mine), -1)
        following[self.previous[linked]] = linked
        before, after, costs = self.possible
        cost = np.full(len(mine), np.inf)
        is_taken = self.previous[after] == before
        cost[after[is_taken]] = costs[is_taken]
        elsewhere, from_others = mine[before] & ~mine[after], mine[after] & ~mine[before]
        links = np.concatenate([following[before[elsewhere]], after[from_others]])
        rivals = np.concatenate([costs[elsewhere], costs[from_others]])
        factor, more = _AS_GOOD
        close = (links >= 0) & (self.previous[links] >= 0) & (rivals <= factor * np.maximum(cost[links], 0) + more)
        doubts = np.zeros(len(mine), bool)
        doubts[links[close]] = True
        return doubts


def find_tracks(people: Detections) -> Tracks:
    """Return who is who: what hardly moves from a frame to the next first, then all else, the surest first."""
    number = len(people.places)
    previous, following = np.full(number, -1), np.full(number, -1)
    first, last = (np.searchsorted(people.places, people.places + 1, side) for side in ("left", "right"))
    possible = _feasible(people, *_pairs(np.arange(len(people.places)), first, last), people.points, people.points)
    _take(possible, previous, following, _SURE + _SURE_PER_SECOND / people.rate_hz)
    for _ in range(_MAX_ROUNDS):
        ends, begins = np.flatnonzero(following < 0), np.flatnonzero(previous < 0)
        until, since = _steady(people, previous, ends), _steady(people, following, begins)
        more = _feasible(people, *_over_gaps(people.places, ends, begins), until, since)
        possible = _joined([possible, more])
        if not _take(possible, previous, following):
            break
    numbers = np.empty(number, dtype=np.intp)
    for index, earlier in enumerate(previous.tolist()):
        numbers[index] = index if earlier < 0 else numbers[earlier]
    return Tracks(numbers, previous, possible)


def seen_twice(people: Detections) -> npt.NDArray[np.bool_]:
    """Return which detections, shape (n,), are of a body of which another in the same frame has more points."""
    number = np.arange(len(people.places))
    pairs = _pairs(number, number + 1, np.searchsorted(people.places, people.places, "right"))
    one, other, _ = _feasible(people, *pairs, people.points, people.points)
    points = np.isfinite(people.points[..., 0]).sum(axis=1)
    twice = np.zeros(len(number), dtype=bool)
    twice[np.where(points[other] > points[one], one, other)] = True
    return twice


def _over_gaps(places: Indices, ends: Indices, begins: Indices) -> tuple[Indices, Indices]:
    first = np.searchsorted(places[begins], places[ends], "right")
    most = min(_NEXT, max(_MAX_OVER_GAPS // max(len(ends), 1), 1))
    before, after = _pairs(ends, first, np.minimum(first + most, len(begins)))
    return before, begins[after]


def _pairs(items: Indices, first: Indices, last: Indices) -> tuple[Indices, Indices]:
    counts = last - first
    if counts.sum() > _MAX_PAIRS:
        raise UnusableFileError("has more persons in its frames than can be told apart; keep those near the infant")
    offsets = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.repeat(items, counts), np.repeat(first, counts) + offsets


def _steady(people: Detections, neighbours: Indices, items: Indices) -> FloatArray:
    """Return points with the medians of a few frames of their tracks for *items*; no neighbour is -1."""
    known = np.append(people.points, np.full((1, *people.points.shape[1:]), np.nan), axis=0)
    neighbours = np.append(neighbours, -1)
    near = [items]
    for _ in range(round(min(_REMEMBERED_S * people.rate_hz, _REMEMBERED))):
        near.append(neighbours[near[-1]])
    points = people.points.copy()
    points[items] = _medians(known[np.stack(near, axis=1)])
    return points


def _feasible(people: Detections, before: Indices, after: Indices, until: FloatArray, since: FloatArray) -> Links:
    """Return those of some pairs, indices *before* and *after*, that may be one person, with their costs.

    *until* are the points of the first ones, shape (n, k, 2), with those seen shortly before, *since* of the second
    ones, with those seen shortly after.
    """
    chunks = [slice(start, start + _CHUNK) for start in range(0, len(before), _CHUNK)] or [slice(0)]
    radii = _radii(people.points)
    radii = np.maximum(radii, np.median(radii) / 2)  # Of bodies that are hardly seen.
    kept = [_of_one_person(people, radii, before[chunk], after[chunk], until, since) for chunk in chunks]
    return _joined(kept)


def _joined(links: Sequence[Links]) -> Links:
    return Links(*(np.concatenate(parts) for parts in zip(*links, strict=True)))


def _of_one_person(
    people: Detections, radii: FloatArray, before: Indices, after: Indices, until: FloatArray, since: FloatArray
) -> Links:
    gaps_s = (people.places[after] - people.places[before]) / people.rate_hz
    one, other = until[before], since[after]
    radius = np.minimum(radii[before], radii[after])
    apart = _lengths(one - other)
    comparable = np.isfinite(apart).sum(axis=1) >= _MIN_SHARED
    moved = np.where(comparable, _medians(apart), _lengths(_medians(one) - _medians(other))) / radius
    names = people.identities[before], people.identities[after]
    known = np.where(np.minimum(*names) >= 0, np.where(names[0] == names[1], -_KNOWN, _KNOWN), 0.0)
    costs = moved + _PER_SECOND * gaps_s + known
    near = np.flatnonzero(moved <= np.minimum(_AT_ONCE + _SPEED * gaps_s, _FARTHEST))
    shared = np.where(np.isfinite(apart[near, :, None]), 1.0, np.nan)
    sizes = _radii(shared * one[near]), _radii(shared * other[near])
    measurable = comparable[near] & (np.minimum(*sizes) > _MIN_SIZE * radius[near])
    growth = np.where(measurable, np.maximum(*sizes) / np.where(measurable, np.minimum(*sizes), 1.0), 1.0)
    possible = near[growth <= _GROWS]
    return Links(before[possible], after[possible], costs[possible])


def _radii(points: FloatArray) -> FloatArray:
    """Return the mean distance of points, shape (m, k, 2), from their median, shape (m,).

    Wild points count as if they were not farther than a few times the median.
    """
    far = _lengths(points - _medians(points)[:, None])
    far = np.minimum(far, _WILD * _medians(far)[:, None])
    seen = np.isfinite(far)
    return np.where(seen, far, 0.0).sum(axis=1) / np.maximum(seen.sum(axis=1), 1)


def _lengths(vectors: FloatArray) -> FloatArray:
    return np.hypot(vectors[..., 0], vectors[..., 1])


def _medians(values: FloatArray) -> FloatArray:
    """Return medians along the second axis of what is not NaN, the lower one of two; NaN of nothing."""
    ordered = np.sort(values, axis=1)  # NaN last.
    middle = np.maximum(np.isfinite(values).sum(axis=1, keepdims=True) - 1, 0) // 2
    return np.take_along_axis(ordered, middle, axis=1)[:, 0]


def _take(links: Links, previous: Indices, following: Indices, most: float = np.inf) -> bool:
    """Take links up to a cost, the cheapest first, between detections that have none yet; return whether any was."""
    free = np.flatnonzero((links.costs <= most) & (following[links.before] < 0) & (previous[links.after] < 0))
    order = free[np.argsort(links.costs[free], kind="stable")]
    for before, after in zip(links.before[order].tolist(), links.after[order].tolist(), strict=True):
        if following[before] < 0 and previous[after] < 0:
            following[before], previous[after] = after, before
    return len(free) > 0


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
    several = [(frame, number, who) for frame in frames for number, who in enumerate(frame.persons)]
    if not several:
        raise UnusableFileError("has nobody in any frame; check that the pose estimator sees the infant")
    numbers = _rows([(frame.where, who) for frame, _, who in several], 3 * points).reshape(-1, points, 3)
    seen = np.isfinite(numbers).all(axis=-1) & (numbers[..., 2] > 0) & numbers[..., :2].any(axis=-1)
    sure = seen & (numbers[..., 2] >= least)
    there = np.flatnonzero(sure.any(axis=1))
    if not len(there):
        raise UnusableFileError(f"has no point with a confidence of {least:g} or more; give a lower one: min_score=0")
    placed = np.where(sure[..., None], numbers[..., :2].clip(-1e9, 1e9), np.nan)
    places = np.array([frame.place for frame, _, _ in several])
    names = sorted({who.identity for _, _, who in several} - {""})
    index = {name: number for number, name in enumerate(names)}
    identities = _unique_identities(np.array([index.get(who.identity, -1) for _, _, who in several]), places)
    said_hz = options.rate_hz or _RATE_HZ
    rate_hz = said_hz if RATES_HZ[0] <= said_hz <= RATES_HZ[1] else _RATE_HZ
    once = ~seen_twice(Detections(places[there], placed[there], identities[there], rate_hz))
    there = there[once]
    box = np.fmax.reduce(placed[there], axis=1) - np.fmin.reduce(placed[there], axis=1)
    people = _People(
        names,
        identities[there],
        np.array([number for _, number, _ in several])[there],
        places[there],
        np.linalg.norm(box, axis=-1),
        find_tracks(Detections(places[there], placed[there], identities[there], rate_hz)),
    )
    infant = None if options.infant is None else identity(options.infant) or str(options.infant)
    track, notes = _choose(people, frames, infant)
    mine = people.tracks.numbers == track
    chosen, at = there[mine], people.places[mine]
    shape = frames[-1].place + 1, points
    positions, confidence = np.full((*shape, 2), np.nan), np.zeros(shape)
    positions[at] = np.where(seen[..., None], numbers[..., :2], np.nan)[chosen]
    confidence[at] = np.where(seen, numbers[..., 2], 0.0)[chosen].clip(0, 1)
    return positions, confidence, (*notes, *_account(people, track))


def _unique_identities(identities: Indices, places: Indices) -> Indices:
    """Return identities without those that several persons in a frame have, as AlphaPose's 0 if it does not track."""
    named = identities >= 0
    frames = int(places.max()) + 1
    pairs, times = np.unique(identities[named] * frames + places[named], return_counts=True)
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
        most, where = len(first.persons) - 1, one_line(first.where)
        raise UnusableFileError(f"has no person '{one_line(infant)}' in {where}; give 0 to {most}")
    who = f"number {infant} of {len(first.persons)} persons in {one_line(first.where)}"
    return int(numbers[meant][0]), (f"the infant is taken to be {who}, and is followed from there",)


def _largest(people: _People) -> int:
    """Return the track of the largest of those who are seen for long and, where some are tracked, of these."""
    named = people.identities >= 0
    times = np.bincount(people.tracks.numbers[named if named.any() else ...])
    return int(np.argmax(np.where(times >= _LONG * times.max(), people.track_sizes[: len(times)], 0.0)))


def _guess(people: _People, frames: Sequence[Frame], track: int) -> str:
    """Return who is taken for the infant, and in what share of frames that is doubtful."""
    numbers, name = people.tracks.numbers, people.identity_of(track)
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
    times, sizes = np.bincount(numbers), people.track_sizes
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

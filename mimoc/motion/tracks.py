"""Tracks of persons: which of the detections in the frames of a recording are of the same person."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from mimoc.bundle.regular_files import UnusableFileError
from mimoc.motion.point_recording import FloatArray

Indices = npt.NDArray[np.intp]

_AT_ONCE = 0.3
"""Movement that is possible from a frame to the next at any frame rate, in radii (`_radii`). Kicking infants of three
months moved .1 at 25 frames a second, and .44 within a second."""
_SPEED = 4.0
"""Further movement, in radii a second, the radius of an infant being about .17 m: .7 m/s, as when it is picked up."""
_FARTHEST = 1.5  # Largest movement, in radii: about .25 m. Adults who sit beside an infant are 2 away, and more.
_GROWS = 1.45
"""Largest ratio of the radii of two detections of one person. Those of kicking infants changed by up to 1.3 within a
second, as legs are drawn up."""
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
_MAX_ROUNDS = 20  # Most rounds of joining over gaps: most films need two or three.
_MAX_PAIRS = 4_000_000
"""Most pairs in the same or consecutive frames: 2.4 hours at 30 frames a second with four persons, or ten minutes with
fifteen."""
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
    count = len(people.places)
    previous, following = np.full(count, -1), np.full(count, -1)
    first, last = (np.searchsorted(people.places, people.places + 1, side) for side in ("left", "right"))
    possible = _feasible(people, *_pairs(np.arange(count), first, last), people.points, people.points)
    _take(possible, previous, following, _SURE + _SURE_PER_SECOND / people.rate_hz)
    for _ in range(_MAX_ROUNDS):
        ends, begins = np.flatnonzero(following < 0), np.flatnonzero(previous < 0)
        until, since = _steady(people, previous, ends), _steady(people, following, begins)
        more = _feasible(people, *_over_gaps(people.places, ends, begins), until, since)
        possible = _joined([possible, more])
        if not _take(possible, previous, following):
            break
    numbers = np.empty(count, dtype=np.intp)
    for index, earlier in enumerate(previous.tolist()):
        numbers[index] = index if earlier < 0 else numbers[earlier]
    return Tracks(numbers, previous, possible)


def seen_twice(people: Detections) -> npt.NDArray[np.bool_]:
    """Return which detections, shape (n,), are of a body of which another in the same frame has more points."""
    indices = np.arange(len(people.places))
    pairs = _pairs(indices, indices + 1, np.searchsorted(people.places, people.places, "right"))
    first, second, _ = _feasible(people, *pairs, people.points, people.points)
    points = np.isfinite(people.points[..., 0]).sum(axis=1)
    twice = np.zeros(len(indices), dtype=bool)
    twice[np.where(points[second] > points[first], first, second)] = True
    return twice


def _over_gaps(places: Indices, ends: Indices, begins: Indices) -> tuple[Indices, Indices]:
    """Return pairs of the end of a track, and the beginning of one of the next tracks in later frames."""
    first = np.searchsorted(places[begins], places[ends], "right")
    most = min(_NEXT, max(_MAX_OVER_GAPS // max(len(ends), 1), 1))
    before, after = _pairs(ends, first, np.minimum(first + most, len(begins)))
    return before, begins[after]


def _pairs(items: Indices, first: Indices, last: Indices) -> tuple[Indices, Indices]:
    """Return each item as often as there are indices from its *first* up to its *last*, and these indices."""
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
    radii = np.maximum(radii, np.median(radii) / 2)  # The least is for bodies that are hardly seen.
    kept = [_of_one_person(people, radii, before[chunk], after[chunk], until, since) for chunk in chunks]
    return _joined(kept)


def _joined(links: Sequence[Links]) -> Links:
    return Links(*(np.concatenate(parts) for parts in zip(*links, strict=True)))


def _of_one_person(
    people: Detections, radii: FloatArray, before: Indices, after: Indices, until: FloatArray, since: FloatArray
) -> Links:
    """Return those of a chunk of pairs that may be one person, with their costs; see `_feasible`.

    Over a gap of t seconds, points may move by min(`_AT_ONCE` + `_SPEED` t, `_FARTHEST`) radii, and the radius of the
    points that both detections have may change by the factor `_GROWS`. Movement is the median distance between these
    points or, if they are too few, the distance between the medians of all points. A pair costs its movement, in radii,
    + `_PER_SECOND` t, - `_KNOWN` if both have the same identity, and + `_KNOWN` if they have different ones.
    """
    gaps_s = (people.places[after] - people.places[before]) / people.rate_hz
    earlier, later = until[before], since[after]
    radius = np.minimum(radii[before], radii[after])
    apart = _lengths(earlier - later)
    comparable = np.isfinite(apart).sum(axis=1) >= _MIN_SHARED
    moved = np.where(comparable, _medians(apart), _lengths(_medians(earlier) - _medians(later))) / radius
    identities = people.identities[before], people.identities[after]
    same = identities[0] == identities[1]
    known = np.where(np.minimum(*identities) >= 0, np.where(same, -_KNOWN, _KNOWN), 0.0)
    costs = moved + _PER_SECOND * gaps_s + known
    near = np.flatnonzero(moved <= np.minimum(_AT_ONCE + _SPEED * gaps_s, _FARTHEST))
    shared = np.where(np.isfinite(apart[near, :, None]), 1.0, np.nan)
    sizes = _radii(shared * earlier[near]), _radii(shared * later[near])
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

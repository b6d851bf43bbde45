"""Points that are, for some frames, where no limb can be: an estimator took something else for them."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from mimoc.bundle.regular_files import first_of
from mimoc.motion.point_recording import PointRecording

Mask = npt.NDArray[np.bool_]
Pairs = Mapping[tuple[str, str], tuple[float, float]]
"""How far two points may be apart, in trunks: at least and at most."""

_FASTEST = 15.0
"""Trunks a second, about 3 m/s. Twice as fast as kicks of infants (their feet reach 3 to 7)."""
_LEAST_JUMP = 0.3
"""Trunks; jitter of estimators is less."""
_MANY = 0.5
"""Share of frames from which on points that are out of reach are not a few that went wrong."""
_OUTER = 1.5
"""How much more the second point of a pair, which is farther out on a limb, is suspected."""
_SHOWN = 3


def drop_wild(recording: PointRecording, apart: Pairs) -> PointRecording:
    """Return a recording without points that jump away and back, or out of reach, and a note of how many they are."""
    jumping = _jumping(recording)
    wild = jumping | _out_of_reach(_without(recording, jumping), apart)
    if not wild.any():
        return recording
    shares = dict(zip(recording.names, wild.mean(axis=0).tolist(), strict=True))
    worst = sorted((name for name in shares if shares[name]), key=shares.__getitem__, reverse=True)
    shown = first_of([f"{name} in {shares[name]:.1%} of frames" for name in worst], _SHOWN)
    note = f"points that jump to where no limb can be are taken not to be seen: {shown}; min_score may leave out more"
    return replace(_without(recording, wild), notes=(*recording.notes, note))


def _without(recording: PointRecording, points: Mask) -> PointRecording:
    positions = np.where(points[..., None], np.nan, recording.positions)
    return replace(recording, positions=positions, confidence=np.where(points, 0.0, recording.confidence))


def _farthest(recording: PointRecording) -> float:
    """Return how far a point can move from a frame to the next, in trunks."""
    return max(_FASTEST / recording.rate_hz, _LEAST_JUMP)


def _jumping(recording: PointRecording) -> Mask:
    """Return which points, shape (t, k), are too far both from where they were before and from where they are next."""
    wild = np.zeros(recording.confidence.shape, bool)
    limit = _farthest(recording) * recording.trunk
    for index, name in enumerate(recording.names):
        places = recording.path(name)
        frames = np.flatnonzero(np.isfinite(places).all(axis=1))
        if len(frames) > 2:
            steps = np.linalg.norm(np.diff(places[frames], axis=0), axis=1)
            far = np.concatenate([[True], steps > limit * np.diff(frames), [True]])
            wild[frames, index] = far[:-1] & far[1:]
    return wild


def _out_of_reach(recording: PointRecording, apart: Pairs) -> Mask:
    """Return which points, shape (t, k), jump out of reach of neighbours; of two, the one that more of these miss.

    Points that are always too far apart have wrong names instead.
    """
    index = {name: number for number, name in enumerate(recording.names)}
    far: dict[tuple[int, int], Mask] = {}
    for (first, second), (_, most) in apart.items():
        if first in index and second in index:
            pair = index[first], index[second]
            is_far = _distances(recording, *pair) > most
            if _is_sudden(recording, pair, is_far):
                far[pair] = is_far
    wild = np.zeros(recording.confidence.shape, bool)
    while far:
        suspected = np.zeros(wild.shape)
        for (first, second), is_far in far.items():
            left = is_far & ~wild[:, first] & ~wild[:, second]
            suspected[left, first] += 1
            suspected[left, second] += _OUTER
        frames = np.flatnonzero(suspected.any(axis=1))
        if not len(frames):
            break
        wild[frames, suspected[frames].argmax(axis=1)] = True
    return wild


def _is_sudden(recording: PointRecording, pair: Sequence[int], is_far: Mask) -> bool:
    """Return whether two points are seldom too far apart, and jump when they begin or cease to be."""
    known = np.isfinite(_distances(recording, *pair))
    changes = np.flatnonzero(np.diff(is_far[known]))
    if not len(changes) or is_far[known].mean() > _MANY:
        return False
    places = recording.positions[known][:, [*pair]]
    jumps = np.linalg.norm(places[changes + 1] - places[changes], axis=-1).max(axis=1) / recording.trunk
    return bool(np.median(jumps) > _farthest(recording) / 2)


def _distances(recording: PointRecording, first: int, second: int) -> npt.NDArray[np.float64]:
    return np.linalg.norm(recording.positions[:, first] - recording.positions[:, second], axis=1) / recording.trunk

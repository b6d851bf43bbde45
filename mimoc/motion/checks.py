"""What is wrong with a recording of points: an error where it cannot be used, a note where it can."""

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from mimoc.bundle.regular_files import UnusableFileError, first_of, one_line
from mimoc.motion.frame_files import MAX_FRAMES
from mimoc.motion.labels import SIDES
from mimoc.motion.point_recording import FloatArray, PointRecording, Up, View
from mimoc.motion.sides import (
    facing,
    mirrored,
    repair_exchanges,
    share_from_behind,
    share_of_knees_backwards,
    share_opposed,
    swapped,
)

Mask = npt.NDArray[np.bool_]
Pairs = Mapping[tuple[str, str], tuple[float, float]]
"""How far two points may be apart, in trunks: at least and at most."""

_FASTEST = 15.0  # Trunks a second, about 3 m/s. Twice as fast as kicks of infants (their feet reach 3 to 7).
_MIN_JUMP = 0.3  # Trunks; jitter of estimators is less.
_MANY = 0.5  # Share of frames from which on points that are out of reach are not a few that went wrong.
_OUTER = 1.5  # How much more the second point of a pair, which is farther out on a limb, is suspected.
_MAX_LISTED = 3


def drop_wild(recording: PointRecording, apart: Pairs) -> PointRecording:
    """Return a recording without points that jump away and back, or out of reach, and a note of how many they are."""
    jumping = _jumping(recording)
    wild = jumping | _out_of_reach(_without(recording, jumping), apart)
    if not wild.any():
        return recording
    shares = dict(zip(recording.names, wild.mean(axis=0).tolist(), strict=True))
    worst = sorted((name for name in shares if shares[name]), key=shares.__getitem__, reverse=True)
    shown = first_of([f"{name} in {shares[name]:.1%} of frames" for name in worst], _MAX_LISTED)
    note = f"points that jump to where no limb can be are taken not to be seen: {shown}; min_score may leave out more"
    return replace(_without(recording, wild), notes=(*recording.notes, note))


def _without(recording: PointRecording, points: Mask) -> PointRecording:
    positions = np.where(points[..., None], np.nan, recording.positions)
    return replace(recording, positions=positions, confidence=np.where(points, 0.0, recording.confidence))


def _farthest(recording: PointRecording) -> float:
    """Return how far a point can move from a frame to the next, in trunks."""
    return max(_FASTEST / recording.rate_hz, _MIN_JUMP)


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


RATES_HZ = 1.0, 1000.0
NEEDED = "neck", "left_hip", "right_hip"  # The trunk, in whose lengths all else is measured.
TRUNK_M = 0.08, 0.6
"""Between the trunk of the smallest preterm infant and that of an adult: what is outside is not in metres."""
_MIN_TRUNK_PX = 5.0
_MOSTLY_INSIDE = 0.9  # Share of points within a picture; estimators put some beside it.
_MIN_SEEN = 0.1  # Share of frames in which the trunk must be seen.
_FAR = 1e5  # More than the pixels of any picture, or the metres of any room.
_MOSTLY = 0.9  # Share of frames in which sides are wrong that makes them wrong throughout.
_SOMETIMES = 0.1
_MIN_FACING = 0.5  # Cosine of the angle from the vertical up to which the trunk of an infant faces downwards.
_MIN_LYING = 0.7
"""The same from which on it lies on its back: of simulated infants that kick on their backs, it is .71 or more."""
_SHOWN_GAP = 0.01  # Share of frames in which a point is missing that is worth a note.
_PERCENTILE = 95
_FARTHER_MOVES_MORE = ("shoulder", "elbow"), ("elbow", "wrist"), ("elbow", "hand"), ("hip", "knee")
"""Pairs of points: in twelve infants (MINI-RGBD), the second moved at least 1.19 times as far as the first."""
_LESS = 0.75
_STRIDE_S = 0.1
APART: dict[tuple[str, str], tuple[float, float]] = {
    ("left_shoulder", "right_shoulder"): (0.0, 1.2),
    ("left_hip", "right_hip"): (0.0, 0.7),
    ("neck", "head"): (0.1, 0.8),
    ("neck", "nose"): (0.05, 0.7),
    ("neck", "left_shoulder"): (0.05, 0.6),
    ("neck", "right_shoulder"): (0.05, 0.6),
    **{
        (f"{side}_{first}" if first != "nose" else first, f"{side}_{second}"): bounds
        for side in SIDES
        for first, second, bounds in (
            ("shoulder", "elbow", (0.1, 0.75)),
            ("elbow", "wrist", (0.08, 0.75)),
            ("elbow", "hand", (0.12, 1.0)),
            ("wrist", "hand", (0.0, 0.35)),
            ("hip", "knee", (0.12, 0.85)),
            ("knee", "ankle", (0.12, 1.0)),
            ("knee", "foot", (0.15, 1.2)),
            ("ankle", "foot", (0.0, 0.45)),
            ("ankle", "big_toe", (0.0, 0.5)),
            ("ankle", "heel", (0.0, 0.3)),
            ("nose", "eye", (0.0, 0.3)),
            ("nose", "ear", (0.0, 0.5)),
        )
    },
}
"""How far points are apart, in trunks, in the 95th percentile over time. Bodies of mimoc at 0 to 24 months, and twelve
infants seen from above (MINI-RGBD), lie in the middle of these ranges, up to three quarters of the second number: a
trunk may be foreshortened, a hand near the camera looks large, and of a limb that points to it little is seen."""


def check_numbers(recording: PointRecording) -> PointRecording:
    """Return a recording of points seen or NaN, with confidence from 0 to 1, or raise an UnusableFileError."""
    twice = sorted(label for label, times in Counter(recording.names).items() if times > 1)
    if twice:
        raise UnusableFileError(f"has {one_line(first_of(twice, 5))} twice; keep one infant, and each point once")
    if not recording.frames or not recording.names:
        raise UnusableFileError("has no points; check what was exported")
    largest = np.max(np.abs(recording.positions), initial=0.0, where=~np.isnan(recording.positions))
    if largest > _FAR:
        raise UnusableFileError(f"has a point at {largest:.3g} {recording.unit}, out of any picture; export it again")
    seen = ~_missing(recording)
    confidence = np.where(seen, np.nan_to_num(recording.confidence, nan=0.0).clip(0, 1), 0.0)
    return replace(recording, positions=np.where(seen[..., None], recording.positions, np.nan), confidence=confidence)


def are_shares(positions: FloatArray, beside: float = 0.0) -> bool:
    """Return whether positions are shares of a picture, 0 to 1; most may lie *beside* it by this much."""
    places = positions[..., :2][np.isfinite(positions[..., :2]).all(axis=-1)]
    inside = ((places >= -beside) & (places <= 1 + beside)).all(axis=-1)
    return bool(inside.size) and float(inside.mean()) >= _MOSTLY_INSIDE


def in_pixels(recording: PointRecording, picture_px: tuple[int, int] | None) -> PointRecording:
    """Return a recording whose positions, if they are shares of a picture of that size, are pixels."""
    if picture_px is None or recording.unit == "m" or not are_shares(recording.positions, beside=1.0):
        return recording
    note = f"positions are shares of a picture of {picture_px[0]} x {picture_px[1]} pixels"
    return replace(recording, positions=recording.positions * picture_px, notes=(*recording.notes, note))


def drop_unsure(recording: PointRecording, least: float) -> PointRecording:
    """Return a recording without points of less than a confidence; UnusableFileError if few are left."""
    seen = ~_missing(recording)
    unsure = seen & ~(recording.confidence >= least)
    share = float(unsure.sum() / max(seen.sum(), 1))
    if not share:
        return recording
    if share > _MOSTLY:
        raise UnusableFileError(
            f"has a confidence below {least:g} at {share:.0%} of its points; if they can be trusted: min_score=0"
        )
    note = f"{100 * share:.2g} % of points have a confidence below {least:g}, and are taken not to be seen"
    positions = np.where(unsure[..., None], np.nan, recording.positions)
    confidence = np.where(unsure, 0.0, recording.confidence)
    return replace(recording, positions=positions, confidence=confidence, notes=(*recording.notes, note))


def check_timing(recording: PointRecording, rate_hz: float | None) -> PointRecording:
    """Return a recording with its frame rate, which a user may give, or raise an UnusableFileError."""
    notes = recording.notes
    if recording.frames < 2:
        raise UnusableFileError("has one frame, and no movement; give all frames of a film")
    if recording.frames > MAX_FRAMES:
        raise UnusableFileError(f"has {recording.frames:,} frames; mimoc reads up to {MAX_FRAMES:,}: cut it")
    known = math.isfinite(recording.rate_hz)
    if rate_hz is None and not known:
        raise UnusableFileError("has no frame rate; say how many frames a second the camera took: rate_hz=30")
    rate = recording.rate_hz if rate_hz is None else float(rate_hz)
    check_rate(rate)
    if rate_hz is not None and known and abs(rate / recording.rate_hz - 1) > 0.01:
        notes = (*notes, f"its own frame rate is {recording.rate_hz:.4g}, and not {rate:g} frames/s, as was given")
    return replace(recording, rate_hz=rate, notes=notes)


def check_rate(rate_hz: float) -> None:
    """Raise an UnusableFileError if a frame rate is none of a camera or of motion capture."""
    least, most = RATES_HZ
    if not least <= rate_hz <= most:
        raise UnusableFileError(f"has {rate_hz:g} frames a second; give a frame rate from {least:g} to {most:g}")


def check_points(recording: PointRecording, view: View | None, up: Up | None = None) -> PointRecording:
    """Return a recording whose points are where those of an infant can be, or raise an UnusableFileError.

    *view* is what was said of what the camera sees, *up* which axis points upwards; None asks nothing of sides and of
    how the infant lies.
    """
    _check_trunk(recording)
    _check_unit(recording)
    whole = drop_wild(repair_exchanges(recording), APART)
    if view == "mirrored":
        is_z = whole.unit == "m" and _share_of(facing(mirrored(whole))[:, 2] < -_MIN_FACING) > _MOSTLY
        whole = mirrored(whole, 2 if is_z else 0)
    elif view == "swapped":
        whole = swapped(whole)
    _check_proportions(whole)
    asked: tuple[str, ...] = ()
    if view is not None:
        unused = ("up is not used: these points are in a picture",) if up and whole.unit == "px" else ()
        asked = *unused, *_check_sides(whole, view)
        _check_facing(whole, view, up)
    notes = *whole.notes, *asked, *_restless(whole), *_gaps(whole)
    recording = replace(whole, notes=notes)
    unseen = [bool(column.all()) for column in _missing(recording).T]
    names = [name for name, is_unseen in zip(recording.names, unseen, strict=True) if not is_unseen]
    return recording.select(names) if any(unseen) else recording


def _check_trunk(recording: PointRecording) -> None:
    missing = [name for name in NEEDED if name not in recording.names]
    if missing:
        shown = first_of(recording.names, 8)
        raise UnusableFileError(
            f"has no {', '.join(missing)}, only {shown}; name its points: names={{'label': '{missing[0]}'}}"
        )
    seen = np.isfinite(recording.select(NEEDED).positions).all(axis=(1, 2)).mean()
    if seen < _MIN_SEEN:
        raise UnusableFileError(f"shows neck and hips in {seen:.0%} of its frames; choose another view of the infant")


def _check_unit(recording: PointRecording) -> None:
    trunk = recording.trunk
    if recording.unit == "px" and trunk < _MIN_TRUNK_PX:
        raise UnusableFileError(
            f"has a trunk {trunk:.2g} px long; give the size of the picture, picture_px=(1920, 1080), or export "
            "pixels, not shares of the picture"
        )
    least, most = TRUNK_M
    if recording.unit == "m" and not least <= trunk <= most:
        raise UnusableFileError(f"has a trunk {trunk:.3g} m long; export positions in metres")


def _check_proportions(recording: PointRecording) -> None:
    """Raise an UnusableFileError if points are apart as on no infant: they are probably in another order."""
    for (first, second), (least, most) in APART.items():
        if not {first, second} <= {*recording.names}:
            continue
        apart = np.linalg.norm(recording.path(first) - recording.path(second), axis=1) / recording.trunk
        apart = apart[np.isfinite(apart)]
        if apart.size and not least <= (far := float(np.percentile(apart, _PERCENTILE))) <= most:
            raise UnusableFileError(
                f"has {first} and {second} {far:.2g} trunks apart, on infants {least:g} to {most:g}; its points may be "
                "in another order: say what its labels are: names={'label': 'left_hip'}"
            )


def _check_sides(recording: PointRecording, view: View) -> tuple[str, ...]:
    """Return what is to be said of left and right, or raise an UnusableFileError if they are wrong throughout."""
    if share_opposed(recording) > _MOSTLY:
        raise UnusableFileError("has its left hip on the side of its right shoulder; check what is left and right")
    if recording.unit == "m" or recording.depth_m is not None:
        if share_of_knees_backwards(recording) > _MOSTLY:
            raise UnusableFileError(
                "has knees that bend backwards: left and right are exchanged (view='swapped'), or the picture or an "
                "axis is mirrored (view='mirrored')"
            )
        return ()
    share = share_from_behind(recording)
    if view == "back" or not share > _SOMETIMES:
        return ()
    if share > _MOSTLY:
        raise UnusableFileError(
            "shows an infant from behind: if it lies on its belly give view='back', if the picture is mirrored or y "
            "counts upwards view='mirrored', if left and right are exchanged view='swapped'"
        )
    return (f"the infant is seen from behind, or left and right are exchanged, in {share:.0%} of frames",)


def _check_facing(recording: PointRecording, view: View, up: Up | None) -> None:
    """Raise an UnusableFileError if an infant in space lies otherwise than was said, so that an axis may be wrong."""
    if recording.unit == "px":
        return
    faces = facing(recording) * (-1 if view == "back" else 1)
    how, otherwise, pose = ("up", "front", "back") if view == "back" else ("down", "back", "belly")
    axis = up or "z"
    opposite = axis[1:] if axis.startswith("-") else f"-{axis}"
    if _share_of(faces[:, 2] < -_MIN_FACING) > _MOSTLY:
        raise UnusableFileError(
            f"lies face {how}: give view='{otherwise}' if it lies on its {pose}, or up='{opposite}' if that axis "
            "points upwards"
        )
    trunks = recording.path("neck") - recording.hips
    trunks = trunks[np.isfinite(trunks).all(axis=1)] / recording.trunk
    if up is not None and _share_of(trunks[:, 2] < -_MIN_FACING) > _MOSTLY:
        raise UnusableFileError(f"hangs head down: give up='{opposite}' if that axis points upwards")
    if up is None and len(faces) and _share_of(faces[:, 2] > _MIN_LYING) < _SOMETIMES:
        middle = np.median(faces, axis=0)
        likely = int(np.argmax(np.abs(middle)))
        sign = "" if middle[likely] > 0 else "-"
        pose = "belly" if view == "back" else "back"
        raise UnusableFileError(
            f"does not lie on its {pose}: give up='{sign}{'xyz'[likely]}' if that axis points upwards, or up='z' if it "
            "sits, stands or lies on its side"
        )


def _share_of(frames: npt.NDArray[np.bool_]) -> float:
    return float(frames.mean()) if frames.size else 0.0


def _restless(recording: PointRecording) -> tuple[str, ...]:
    every = max(1, round(recording.rate_hz * _STRIDE_S))
    strides = np.linalg.norm(recording.positions[every:] - recording.positions[:-every], axis=-1)
    pairs = [(f"{side}_{near}", f"{side}_{far}") for side in SIDES for near, far in _FARTHER_MOVES_MORE]
    wrong = []
    for names in pairs:
        if {*names} <= {*recording.names}:
            near, far = (strides[:, recording.names.index(name)] for name in names)
            both = np.isfinite(near) & np.isfinite(far)
            if both.any() and far[both].sum() < _LESS * near[both].sum():
                wrong.append(" than ".join(names))
    return (f"these move more: {first_of(wrong, 3)}; they may be called each other's name",) if wrong else ()


def _missing(recording: PointRecording) -> npt.NDArray[np.bool_]:
    return np.asarray(np.isnan(recording.positions).any(axis=-1))


def _gaps(recording: PointRecording) -> tuple[str, ...]:
    missing = _missing(recording)
    means = zip(recording.names, missing.mean(axis=0).tolist(), strict=True)
    shares = {name: share for name, share in means if share > _SHOWN_GAP}
    if not shares:
        return ()
    never = [name for name, share in shares.items() if share == 1]
    worst = sorted((name for name in shares if name not in never), key=shares.__getitem__, reverse=True)
    longest = [_longest_gap(missing[:, recording.names.index(name)]) / recording.rate_hz for name in worst]
    gaps = [f"{name} in {shares[name]:.0%} of frames" for name in worst]
    return (
        *((f"never seen, and left out: {first_of(never, 5)}",) if never else ()),
        *((f"not seen: {first_of(gaps, 3)}; the longest gap is {max(longest):.2g} s",) if gaps else ()),
    )


def _longest_gap(missing: npt.NDArray[np.bool_]) -> int:
    edges = np.flatnonzero(np.diff(np.concatenate([[0], missing, [0]])))
    return int(np.max(edges[1::2] - edges[::2], initial=0))

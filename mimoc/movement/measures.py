"""The core measures of movement of one recording, movement units, and kicks."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.signal import find_peaks, welch
from scipy.stats import kurtosis

from mimoc.base.errors import MovementError
from mimoc.base.movement_quantities import CORE
from mimoc.motion.labels import SIDES
from mimoc.motion.point_recording import CUTOFF_HZ, FloatArray, PointRecording

IntArray = npt.NDArray[np.integer]

MIN_RATE_HZ = 2.5 * CUTOFF_HZ  # Slower recordings do not contain what the filter lets pass.
MIN_S = 2.0  # Shorter recordings have too few movements to measure.
MOVING_TRUNK_S = 0.25  # A limb that is faster moves.
KICK_TRUNK = 0.25  # Least extension of a leg that counts as a kick.
STILL = 1e-9  # What varies less is constant but for rounding.
SPECTRUM_S = 256 / 30  # Length of the windows of a spectrum.
ENTROPY_HZ = 10.0  # Rate at which the speed is sampled for its entropy.

TRUNK_POINTS = "neck", "left_hip", "right_hip"
LIMB_POINTS = "hand", "elbow", "foot", "knee"
STAND_INS: Mapping[str, tuple[str, ...]] = {"hand": ("wrist",), "foot": ("big_toe", "ankle")}
"""What is measured where a pose estimator does not know a hand or a foot, the best first. Wrists and ankles move less:
speeds come out lower."""
_NEEDED = ("neck", *(f"{side}_{part}" for side in SIDES for part in ("elbow", "hand", "hip", "knee", "foot")))
"""Points that every measure can rely on."""
_WANTED = {*_NEEDED, "left_shoulder", "right_shoulder", "head", "nose"}
"""Points that are kept of a recording."""


def movement_units(speed: FloatArray) -> IntArray:
    r"""Return the frames of the maxima of a speed that are movement units.

    They are at least .25 trunk/s, and rise from and fall to both sides by at least .125 trunk/s (their prominence)::

        speed    A
                / \    b    C
               /   \  / \  / \       A and C are units; b is none, for it rises too little
             _/     \/   \/   \_

    Args:
        speed: In the frame of the trunk, without what is faster than 6 Hz, shape (t,), [trunk/s].
    """
    return find_peaks(speed, height=MOVING_TRUNK_S, prominence=MOVING_TRUNK_S / 2)[0]


def unit_spans(speed: FloatArray) -> list[tuple[int, int, int]]:
    """Return the first, the fastest and the last frame of each movement unit, from minimum to minimum of the speed.

    Units that the ends of the recording cut off are left out.
    """
    minima = find_peaks(-speed)[0]
    spans = []
    for peak in movement_units(speed).tolist():
        after = int(np.searchsorted(minima, peak))  # Index of the first minimum after the unit.
        if 0 < after < len(minima):
            spans.append((int(minima[after - 1]), peak, int(minima[after])))
    return spans


def _recorded_units(part: str, columns: Mapping[str, Any]) -> int | None:
    """Return how many movement units a part has in the movement columns of an episode.

    None if positions are not finite, or there are fewer than two. The path is that of the part's centre of mass in the
    frame of the trunk in space: with h the middle of the hips, n the neck, l and r the hips and T the median of
    |n - h|, which is the unit of length, the axes are u along n - h, w along l - r without its share along u, and
    u x w.
    """
    names = (*TRUNK_POINTS, part)
    places_m = np.stack([[np.asarray(columns[f"{name}_{axis}_m"], float) for axis in "xyz"] for name in names])
    if not np.isfinite(places_m).all() or places_m.shape[-1] < 2:
        return None
    rate_hz = 1 / float(np.median(np.diff(np.asarray(columns["time_s"], float))))
    confidence = np.ones((places_m.shape[-1], len(names)))
    whole = PointRecording("episode", rate_hz, names, places_m.transpose(2, 0, 1), confidence).smoothed()
    neck, left_hip, right_hip, centre = np.moveaxis(whole.positions, 1, 0)
    mid_hip = (left_hip + right_hip) / 2
    trunk = neck - mid_hip
    lengths = np.linalg.norm(trunk, axis=1, keepdims=True)
    along = trunk / lengths
    between_hips = left_hip - right_hip
    across = between_hips - (between_hips * along).sum(1, keepdims=True) * along
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    axes = along, across, np.cross(along, across)
    path = np.stack([((centre - mid_hip) * axis).sum(axis=1) for axis in axes], axis=-1) / np.median(lengths)
    speed = np.linalg.norm(np.gradient(path, axis=0) * rate_hz, axis=1)
    return len(movement_units(speed))


right_hand_movement_units = partial(_recorded_units, "right_hand")
left_hand_movement_units = partial(_recorded_units, "left_hand")
right_foot_movement_units = partial(_recorded_units, "right_foot")
left_foot_movement_units = partial(_recorded_units, "left_foot")


@dataclass(frozen=True)
class TrunkPaths:
    """Paths of points over t frames; origin at the middle of the hips, unit the length of the trunk.

    The axis *along* points from the hips to the neck, *across* is it turned by 90 degrees. With p a point, h the middle
    of the hips, n the neck and T the median of |n - h|: u = (n - h) / |n - h|, along = (p - h) . u / T.
    """

    rate_hz: float
    paths: Mapping[str, FloatArray]  # Across and along, shape (t, 2) each, [trunk], by the name of the point.
    velocities: Mapping[str, FloatArray]  # Central differences, shape (t, 2) each, [trunk/s].
    speeds: Mapping[str, FloatArray]  # Their lengths, shape (t,) each, [trunk/s].

    @property
    def minutes(self) -> float:
        """Duration of the recording."""
        return len(self.paths["neck"]) / self.rate_hz / 60

    def sides(self, part: str) -> list[FloatArray]:
        """Return the paths of a part on the left and on the right, shape (t, 2) each, [trunk]."""
        return [self.paths[f"{side}_{part}"] for side in SIDES]

    def both(self, part: str) -> FloatArray:
        """Return the speeds of a part on both sides, shape (2, t), [trunk/s]."""
        return np.stack([self.speeds[f"{side}_{part}"] for side in SIDES])


def trunk_paths(recording: PointRecording) -> TrunkPaths:
    """Return the paths of a recording's points in the frame of the trunk, without what is faster than 6 Hz.

    Points in space are taken as a camera straight above sees them from afar: by x and y.

    Raises:
        MovementError: If points are missing or never seen, or it is too slow or too short for measures of movement.
    """
    if recording.rate_hz < MIN_RATE_HZ:
        problem = f"{recording.rate_hz:g} frames/s are too few to measure movement"
        raise MovementError(f"{recording.name}: {problem}; record at least {MIN_RATE_HZ:g}")
    if recording.frames < MIN_S * recording.rate_hz:
        problem = f"{recording.frames} frames are too few to measure movement"
        raise MovementError(f"{recording.name}: {problem}; record at least {MIN_S:g} s")
    smooth = _with_stand_ins(recording).smoothed()
    flat = np.array(smooth.positions[..., :2])
    hips = (flat[:, smooth.names.index("left_hip")] + flat[:, smooth.names.index("right_hip")]) / 2
    trunk = flat[:, smooth.names.index("neck")] - hips
    lengths = np.linalg.norm(trunk, axis=1)
    if not lengths.min() > 0:
        raise MovementError(f"{recording.name}: the neck lies between the hips; check the names of the points")
    along = trunk / lengths[:, None]
    across = np.stack([-along[:, 1], along[:, 0]], axis=-1)
    away = flat - hips[:, None]
    placed = np.stack([(away * axis[:, None]).sum(-1) for axis in (across, along)], axis=-1) / np.median(lengths)
    paths = {name: placed[:, index] for index, name in enumerate(smooth.names)}
    velocities = {name: np.gradient(path, axis=0) * recording.rate_hz for name, path in paths.items()}
    speeds = {name: np.linalg.norm(velocity, axis=1) for name, velocity in velocities.items()}
    return TrunkPaths(recording.rate_hz, paths, velocities, speeds)


def stand_ins(names: Sequence[str]) -> dict[str, str]:
    """Return which of a recording's points are measured in place of hands, feet and neck that it does not have."""
    chosen = {}
    for side in SIDES:
        for part, others in STAND_INS.items():
            known = [f"{side}_{name}" for name in (part, *others) if f"{side}_{name}" in names]
            if known and known[0] != f"{side}_{part}":
                chosen[f"{side}_{part}"] = known[0]
    return chosen


def _with_stand_ins(recording: PointRecording) -> PointRecording:
    """Return a recording of the points that are kept, in which stand-ins have the names of what they stand in for."""
    renamed = {present: absent for absent, present in stand_ins(recording.names).items()}
    kept = recording.select([name for name in recording.names if renamed.get(name, name) in _WANTED])
    names = tuple(renamed.get(name, name) for name in kept.names)
    missing = [name for name in _NEEDED if name not in names]
    if missing:
        raise MovementError(f"{recording.name}: has no {', '.join(missing)}; measures of movement need all of them")
    seen: FloatArray = np.isfinite(kept.positions).all(axis=-1).max(axis=0, initial=False)
    unseen = [name for index, name in enumerate(names) if name in _NEEDED and not seen[index]]
    if unseen:
        raise MovementError(f"{recording.name}: {', '.join(unseen)} never seen; measures of movement need all of them")
    used = [index for index, name in enumerate(names) if seen[index]]
    used_names = tuple(names[index] for index in used)
    return PointRecording(
        recording.name, recording.rate_hz, used_names, kept.positions[:, used], kept.confidence[:, used]
    )


def core_measures(recording: PointRecording) -> dict[str, float]:
    """Return the 21 measures of `CORE`, in order; MovementError if points are missing, or it is slow or short."""
    return core_of(trunk_paths(recording))


def core_of(body: TrunkPaths) -> dict[str, float]:
    """Return the 21 measures of paths in the frame of the trunk."""
    kicks = [len(find_peaks(length, prominence=KICK_TRUNK)[0]) for length in leg_lengths(body)]
    sides = zip(body.both("hand"), body.both("foot"), strict=True)
    values = {
        **_of_ends(body, "hand", "hands"),
        **_of_ends(body, "foot", "feet"),
        "kicks_per_min": float(np.mean(kicks)) / body.minutes,
        "hand_foot_together_r": float(np.mean([correlation(hand, foot) for hand, foot in sides])),
        "dimensions": _dimensions(body),
    }
    return {quantity.name: values[quantity.name] for quantity in CORE}


def leg_lengths(body: TrunkPaths) -> list[FloatArray]:
    """Return the distance from hip to foot of both legs, shape (t,) each, [trunk]."""
    pairs = zip(body.sides("foot"), body.sides("hip"), strict=True)
    return [np.linalg.norm(foot - hip, axis=1) for foot, hip in pairs]


def sample_entropy(values: FloatArray, length: int = 2, tolerance: float = 0.2) -> float:
    """Return the sample entropy of a signal, [nats]: how unpredictable it is, given its last *length* values.

    -ln(A / B): B pairs of windows of *length* values, and A of those with the next value, whose largest difference is
    below *tolerance* standard deviations; the windows are the first N - *length* of either length. 0 if it is constant.
    """
    deviation = values.std()
    if deviation < STILL:
        return 0.0
    standard = (values - values.mean()) / deviation
    count = len(standard) - length
    shorter = longer = 0
    for start in range(count - 1):  # Row by row: all pairs at once would need the square of ten minutes.
        gaps = [np.abs(standard[start + lag] - standard[start + 1 + lag : count + lag]) for lag in range(length + 1)]
        near = np.logical_and.reduce([gap < tolerance for gap in gaps[:length]])
        shorter += int(near.sum())
        longer += int((near & (gaps[length] < tolerance)).sum())
    return float(-np.log(max(longer, 0.5) / max(shorter, 0.5)))  # Half a pair for none.


def correlation(first: FloatArray, second: FloatArray) -> float:
    """Return the Pearson correlation of two signals; 0 if one is constant."""
    if first.std() < STILL or second.std() < STILL:
        return 0.0
    return float(np.corrcoef(first, second)[0, 1])


def _of_ends(body: TrunkPaths, part: str, parts: str) -> dict[str, float]:
    """Return the measures of a part on both sides by name; *parts* is its plural."""
    speeds = body.both(part)
    every = max(1, round(body.rate_hz / ENTROPY_HZ))
    spreads = [np.sqrt(path.var(axis=0).sum()) for path in body.sides(part)]
    entropies = [sample_entropy(speed[::every]) for speed in speeds]
    kurtoses = [float(kurtosis(speed)) if speed.std() >= STILL else 0.0 for speed in speeds]
    units = [len(movement_units(speed)) for speed in speeds]
    return {
        f"{part}_speed_median_trunk_s": float(np.median(speeds)),
        f"{part}_speed_p95_trunk_s": float(np.percentile(speeds, 95)),
        f"{part}_moving_share": float((speeds > MOVING_TRUNK_S).mean()),
        f"{part}_spread_trunk": float(np.mean(spreads)),
        f"{part}_sample_entropy_nats": float(np.mean(entropies)),
        f"{part}_burstiness": float(np.mean(kurtoses)),
        f"{part}_frequency_hz": _median_frequency(body, part),
        f"{parts}_together_r": correlation(speeds[0], speeds[1]),
        f"{part}_units_per_min": float(np.mean(units)) / body.minutes,
    }


def _median_frequency(body: TrunkPaths, part: str) -> float:
    """Return the frequency below which half of the power of the velocity lies, [Hz]."""
    velocity = np.concatenate([body.velocities[f"{side}_{part}"] for side in SIDES], axis=1)
    window = min(round(SPECTRUM_S * body.rate_hz), len(velocity))
    frequencies, power = welch(velocity, body.rate_hz, nperseg=window, axis=0)
    below = np.cumsum(power.sum(axis=1))
    return float(np.interp(0.5, below / below[-1], frequencies)) if below[-1] > STILL**2 else 0.0


def _dimensions(body: TrunkPaths) -> float:
    ends = np.concatenate([body.paths[f"{side}_{part}"] for side in SIDES for part in LIMB_POINTS], axis=1)
    values = np.linalg.eigvalsh(np.cov(ends.T))
    return float(values.sum() ** 2 / (values**2).sum()) if values.sum() > STILL**2 else 0.0


@dataclass(frozen=True, slots=True)
class Kick:
    """One kick, by its frames: the leg is extended from *start* to *peak*, and flexed until *stop*."""

    start: int
    peak: int
    stop: int
    amplitude_trunk: float  # Prominence of the maximum.
    extension_rate_trunk_s: float  # Largest rate of extension from *start* to *peak*.
    flexion_rate_trunk_s: float  # Largest rate of flexion from *peak* to *stop*.


def kicks_of(length: FloatArray, rate_hz: float) -> list[Kick]:
    r"""Return the kicks of a leg, given the distance from hip to foot, shape (t,), [trunk].

    A kick is a maximum with a prominence of at least .25 trunk; it begins and ends at the minima next to it::

        length     ___peak
                  /       \
        ____start/         \stop____
    """
    peaks, properties = find_peaks(length, prominence=KICK_TRUNK)
    minima = find_peaks(-length)[0]
    rates = np.gradient(length) * rate_hz
    kicks = []
    for peak, amplitude in zip(peaks.tolist(), properties["prominences"].tolist(), strict=True):
        after = int(np.searchsorted(minima, peak))
        start = int(minima[after - 1]) if after else 0
        stop = int(minima[after]) if after < len(minima) else len(length) - 1
        extension = rates[start : peak + 1].max()
        flexion = -rates[peak : stop + 1].min()
        kicks.append(Kick(start, peak, stop, amplitude, float(extension), float(flexion)))
    return kicks

"""The measures of movement of one recording, and its kicks."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks, welch
from scipy.stats import kurtosis

from mimoc.base.quantities.movement import CORE
from mimoc.motion.point_recording import FloatArray, PointRecording
from mimoc.motion.points import SIDES
from mimoc.movement.trunk_frame import TrunkPaths, trunk_paths
from mimoc.runtime.quantities.movement_units import MOVING_TRUNK_S, movement_units

KICK_TRUNK = 0.25
"""Least extension of a leg that counts as a kick."""
STILL = 1e-9
"""What varies less is constant but for rounding."""
SPECTRUM_S = 256 / 30
"""Length of the windows of a spectrum."""
ENTROPY_HZ = 10.0
"""Rate at which entropy looks at speed."""
LIMB_POINTS = "hand", "elbow", "foot", "knee"


def core_measures(recording: PointRecording) -> dict[str, float]:
    """Return the 21 measures of `CORE`, in order; MovementError if points are missing, or it is slow or short."""
    return core_of(trunk_paths(recording))


def core_of(body: TrunkPaths) -> dict[str, float]:
    """Return the 21 measures of paths in the frame of the trunk."""
    values = [value for part in ("hand", "foot") for value in _of_ends(body, part)]
    kicks = [len(find_peaks(length, prominence=KICK_TRUNK)[0]) for length in leg_lengths(body)]
    values.append(float(np.mean(kicks)) / body.minutes)
    sides = zip(body.both("hand"), body.both("foot"), strict=True)
    values += [float(np.mean([correlation(hand, foot) for hand, foot in sides])), _dimensions(body)]
    return dict(zip((quantity.name for quantity in CORE), values, strict=True))


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


def _of_ends(body: TrunkPaths, part: str) -> list[float]:
    both, paths = body.both(part), body.sides(part)
    every = max(1, round(body.rate_hz / ENTROPY_HZ))
    peaks = [len(movement_units(speed)) for speed in both]
    return [
        float(np.median(both)),
        float(np.percentile(both, 95)),
        float((both > MOVING_TRUNK_S).mean()),
        float(np.mean([np.sqrt(path.var(axis=0).sum()) for path in paths])),
        float(np.mean([sample_entropy(one[::every]) for one in both])),
        float(np.mean([float(kurtosis(one)) if one.std() >= STILL else 0.0 for one in both])),
        _median_frequency(body, part),
        correlation(both[0], both[1]),
        float(np.mean(peaks)) / body.minutes,
    ]


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
    amplitude_trunk: float
    """Prominence of the maximum."""
    extension_rate_trunk_s: float
    """Largest rate of extension from *start* to *peak*."""
    flexion_rate_trunk_s: float
    """Largest rate of flexion from *peak* to *stop*."""


def kicks_of(length: FloatArray, rate_hz: float) -> list[Kick]:
    r"""Return the kicks of a leg, given the distance from hip to foot, shape (t,), [trunk].

    A kick is a maximum with a prominence of at least .25 trunk; it begins and ends at the minima next to it::

        length     ___peak
                  /       \
        ____start/         \stop____
    """
    peaks, properties = find_peaks(length, prominence=KICK_TRUNK)
    minima, rates = find_peaks(-length)[0], np.gradient(length) * rate_hz
    kicks = []
    for peak, amplitude in zip(peaks.tolist(), properties["prominences"].tolist(), strict=True):
        after = int(np.searchsorted(minima, peak))
        start = int(minima[after - 1]) if after else 0
        stop = int(minima[after]) if after < len(minima) else len(length) - 1
        extension, flexion = rates[start : peak + 1].max(), -rates[peak : stop + 1].min()
        kicks.append(Kick(start, peak, stop, amplitude, float(extension), float(flexion)))
    return kicks

"""Kicks of a leg: extensions of the distance from hip to foot, each with the flexion after it."""

from dataclasses import dataclass

import numpy as np
from scipy.signal import find_peaks

from mimoc.motion.point_recording import FloatArray
from mimoc.movement.measures import KICK_TRUNK


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

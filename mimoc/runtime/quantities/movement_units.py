"""Movement units: maxima of the speed of a hand or a foot, of points in a film and of recorded episodes alike."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt
from scipy.signal import find_peaks

from mimoc.motion.point_recording import FloatArray, PointRecording

IntArray = npt.NDArray[np.integer]

MOVING_TRUNK_S = 0.25  # A limb that is faster moves.
TRUNK_POINTS = "neck", "left_hip", "right_hip"


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
    afters = [(int(peak), int(np.searchsorted(minima, peak))) for peak in movement_units(speed)]
    return [(int(minima[at - 1]), peak, int(minima[at])) for peak, at in afters if 0 < at < len(minima)]


def _recorded_units(part: str, columns: Mapping[str, Any]) -> int | None:
    """Return how many movement units a part has in the movement columns of an episode; None if it is not there.

    Its centre of mass in the frame of the trunk in space: with h the middle of the hips, n the neck, l and r the hips
    and T the median of |n - h|, the axes are u along n - h, w along l - r without its share along u, and u x w.
    """
    names = (*TRUNK_POINTS, part)
    places_m = np.stack([[np.asarray(columns[f"{name}_{axis}_m"], float) for axis in "xyz"] for name in names])
    if not np.isfinite(places_m).all() or places_m.shape[-1] < 2:
        return None
    rate_hz = 1 / float(np.median(np.diff(np.asarray(columns["time_s"], float))))
    confidence = np.ones((places_m.shape[-1], len(names)))
    whole = PointRecording("episode", rate_hz, names, places_m.transpose(2, 0, 1), confidence).smoothed()
    neck, left, right, at = np.moveaxis(whole.positions, 1, 0)
    middle = (left + right) / 2
    trunk = neck - middle
    lengths = np.linalg.norm(trunk, axis=1, keepdims=True)
    along = trunk / lengths
    across = (left - right) - ((left - right) * along).sum(1, keepdims=True) * along
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    axes = along, across, np.cross(along, across)
    path = np.stack([((at - middle) * axis).sum(axis=1) for axis in axes], axis=-1) / np.median(lengths)
    return len(movement_units(np.linalg.norm(np.gradient(path, axis=0) * rate_hz, axis=1)))


right_hand_movement_units = partial(_recorded_units, "right_hand")
left_hand_movement_units = partial(_recorded_units, "left_hand")
right_foot_movement_units = partial(_recorded_units, "right_foot")
left_foot_movement_units = partial(_recorded_units, "left_foot")

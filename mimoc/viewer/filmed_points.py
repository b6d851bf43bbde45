"""What a page knows of the points that a retargeted recording came from: as recorded, and where the child's own are."""

from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.motion.points import BONES
from mimoc.movement.retargeting.folder import is_retargeted, read_retargeted

EDGE = 0.06
"""Empty margin around the points, as a share of the larger side of their picture."""
FROM_ABOVE = np.array([1.0, -1.0])
"""How places in space are drawn: x to the right, y upwards."""


def points_of(folder: Path) -> dict[str, Any] | None:
    """Return the points of a retargeted recording, or None; MimocError if they are damaged."""
    if not is_retargeted(folder):
        return None
    retargeted = read_retargeted(folder)
    recording, names = retargeted.recording, retargeted.recording.names
    distances = np.linalg.norm(recording.positions - retargeted.fitted.positions, axis=-1) / recording.trunk
    recorded, fitted = _drawn(recording.positions), _drawn(retargeted.fitted.positions)
    known = [bone for bone in BONES if {*bone} <= {*names}]
    both = np.concatenate([recorded, fitted]).reshape(-1, 2)
    low, high = np.nanmin(both, axis=0), np.nanmax(both, axis=0)
    edge = EDGE * float((high - low).max())
    return {
        "rate_hz": recording.rate_hz,
        "bones": np.array([[names.index(point) for point in bone] for bone in known], np.uint32).reshape(-1, 2),
        "recorded": recorded,
        "fitted": fitted,
        "errors": _medians(distances),
        "box": np.concatenate([low - edge, high - low + 2 * edge]),
    }


def _drawn(positions: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    return positions if positions.shape[-1] == 2 else positions[..., :2] * FROM_ABOVE


def _medians(distances: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the median of each row, shape (t,); NaN for a row without any number."""
    known = np.isfinite(distances)
    filled = np.where(known, distances, np.inf)
    order = np.sort(filled, axis=1)
    count = known.sum(axis=1)
    rows = np.arange(len(order))
    middle = (order[rows, np.maximum(count - 1, 0) // 2] + order[rows, np.minimum(count // 2, order.shape[1] - 1)]) / 2
    return np.where(count > 0, middle, np.nan)

"""The law by which a face goes from one expression to another: whole steps on a grid, which can be taken back."""

import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.rotations import FloatArray

STEP_M = 2.0**-17
"""Distance of the grid's points, 7.6 micrometres: fine enough for a face, and sums of such numbers are exact in single
precision."""

Steps = npt.NDArray[np.int16]


def on_grid(verts_m: FloatArray) -> FloatArray:
    """Return the points of the grid nearest to some vertices, shape (n, 3), [m].

    Example:
        >>> import numpy as np
        >>> from mimoc.base.geometry.face_steps import STEP_M, on_grid
        >>> float(on_grid(np.array([[0.1, 0.0, 0.0]]))[0, 0] / STEP_M)
        13107.0
    """
    return np.rint(verts_m / STEP_M) * STEP_M


def steps_between(verts_m: FloatArray, others_m: FloatArray) -> Steps:
    """Return the steps from vertices to others, shape (n, 3)."""
    return np.rint((on_grid(others_m) - on_grid(verts_m)) / STEP_M).astype(np.int16)


def stepped(verts_m: FloatArray, before: Steps | None, after: Steps | None) -> FloatArray:
    """Return vertices of a face that goes from one expression to another, on the grid, shape (n, 3), [m].

    Args:
        verts_m: The vertices now.
        before: Steps from the neutral face to the present one; None if that is neutral.
        after: Steps from the neutral face to the next one; None if that is neutral.

    Example:
        >>> import numpy as np
        >>> from mimoc.base.geometry.face_steps import STEP_M, stepped
        >>> smile = np.array([[0, 0, 8]], np.int16)
        >>> happy = stepped(np.zeros((1, 3)), None, smile)
        >>> (happy / STEP_M).tolist(), stepped(happy, smile, None).tolist()
        ([[0.0, 0.0, 8.0]], [[0.0, 0.0, 0.0]])
    """
    steps: FloatArray = np.rint(np.asarray(verts_m, np.float64) / STEP_M)
    for change, sign in ((before, -1.0), (after, 1.0)):
        if change is not None:
            steps = steps + sign * change.astype(np.float64)
    return steps * STEP_M

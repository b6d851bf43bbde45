"""Functions of one number: roots, minima, and a step with rounded corners."""

from collections.abc import Callable
from typing import Literal

import numpy as np

from mimoc.base.geometry.rotations import FloatArray


def smoothstep(t: FloatArray) -> FloatArray:
    """Return 0 where *t* is below 0, 1 where it is above 1, and t² (3 - 2 t) between.

    Example:
        >>> import numpy as np
        >>> from mimoc.base.geometry.solvers import smoothstep
        >>> smoothstep(np.array([-1.0, 0.25, 0.5, 2.0])).tolist()
        [0.0, 0.15625, 0.5, 1.0]
    """
    t = np.clip(t, 0, 1)
    return t * t * (3 - 2 * t)


SHARES = np.linspace(0.0, 1.0, 41)  # Places between the ends of a bracket that are tried at once for a minimum.


def root(
    function: Callable[[float], float],
    low: float,
    high: float,
    precision: float,
    method: Literal["brentq", "bisect"] = "brentq",
) -> float:
    """Return where *function*, of another sign at *low* than at *high*, is zero; `bisect` also finds where it jumps."""
    from scipy.optimize import root_scalar  # It takes longer to import than most infants take to build.

    return float(root_scalar(function, bracket=(low, high), xtol=precision, method=method).root)


def narrowed(
    function: Callable[[FloatArray], FloatArray], lows: FloatArray, highs: FloatArray, width: float
) -> tuple[FloatArray, FloatArray]:
    """Return brackets of where each of n functions is least, at most *width* wide, each with one minimum in it.

    The function takes m numbers for each, shape (n, m). Every infant is built with it, and SciPy's solvers take longer
    to import than that.
    """
    rows, last = np.arange(len(lows)), len(SHARES) - 1
    while (wide := highs - lows > width).any():
        tried = lows[:, None] + (highs - lows)[:, None] * SHARES
        least = function(tried).argmin(axis=1)
        lows = np.where(wide, tried[rows, np.maximum(least - 1, 0)], lows)
        highs = np.where(wide, tried[rows, np.minimum(least + 1, last)], highs)
    return lows, highs

"""Roots and minima of functions of one number."""

from collections.abc import Callable
from typing import Literal

import numpy as np
import numpy.typing as npt

Function = Callable[[float], float]

SHARES = np.linspace(0.0, 1.0, 41)
"""Places between the ends of a bracket that are tried at once for a minimum."""


def root(
    function: Function, low: float, high: float, precision: float, method: Literal["brentq", "bisect"] = "brentq"
) -> float:
    """Return where *function*, which has another sign at *low* than at *high*, is zero.

    Args:
        function: Continuous for `brentq`; `bisect` also finds where it jumps.
        low: One end of the bracket.
        high: The other end.
        precision: Largest error of the result.
        method: As for `scipy.optimize.root_scalar`.
    """
    from scipy.optimize import root_scalar  # It takes longer to import than most infants take to build.

    return float(root_scalar(function, bracket=(low, high), xtol=precision, method=method).root)


def minimum(
    function: Callable[[npt.NDArray[np.float64]], npt.NDArray[np.float64]], low: float, high: float, precision: float
) -> float:
    """Return where a function, which has one minimum between *low* and *high*, is least.

    Every infant is built with it, and SciPy's solvers take longer to import than that.

    Args:
        function: From n numbers to its n values.
        low: One end of the bracket.
        high: The other end.
        precision: Largest error of the result.
    """
    while high - low > precision:
        tried = low + (high - low) * SHARES
        least = int(function(tried).argmin())
        low, high = float(tried[max(least - 1, 0)]), float(tried[min(least + 1, len(tried) - 1)])
    return (low + high) / 2

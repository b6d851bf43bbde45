"""Roots and minima of functions of one number."""

import math
from collections.abc import Callable
from typing import Literal

Function = Callable[[float], float]

GOLDEN = (math.sqrt(5) - 1) / 2


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


def minimum(function: Function, low: float, high: float, precision: float) -> float:
    """Return where *function*, which has one minimum between *low* and *high*, is least.

    By golden sections: every infant is built with it, and SciPy's solvers take longer to import than that.
    """
    while high - low > precision:
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        low, high = (low, right) if function(left) < function(right) else (left, high)
    return (low + high) / 2

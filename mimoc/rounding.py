"""Numbers as they stand in files: the one place where floats are rounded."""

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

SIGNIFICANT_DIGITS = 9
"""Enough for any body (a nanometre on a metre), too few to show in which order sums were taken."""


def num(value: float | bool | Iterable[float]) -> str:
    """Return a number, or several with blanks between, as MJCF wants them; booleans as true and false."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return f"{value + 0.0:.{SIGNIFICANT_DIGITS}g}"  # + 0.0 turns -0.0 into 0.
    return " ".join(num(item) for item in value)


def rounded(data: Any) -> Any:
    """Return plain data with every float rounded as it is in files."""
    if isinstance(data, float):
        return float(num(data))
    if isinstance(data, Mapping):
        return {key: rounded(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [rounded(item) for item in data]
    return data


def rounded_array(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return an array with every float rounded as it is in files."""
    if array.dtype.kind != "f":
        return array
    numbers = array.ravel().tolist()
    texts = (f"%.{SIGNIFICANT_DIGITS}g " * len(numbers) % tuple(numbers)).split()
    return np.array(texts, array.dtype).reshape(array.shape) + 0.0

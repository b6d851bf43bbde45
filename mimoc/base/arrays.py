"""Arrays in files: numbers are rounded as all others are, and no name in an archive may stand for two arrays."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import DataError
from mimoc.base.rounding import MIN_NORMAL, SIGNIFICANT_DIGITS

Arrays = Mapping[str, npt.NDArray[Any]]


def read_arrays(path: Path) -> dict[str, npt.NDArray[Any]]:
    """Return the arrays of an archive (.npz) by name; DataError if two share one: NumPy gives the last."""
    with np.load(path, allow_pickle=False) as archive:
        _only_once(archive.files, path.name)
        return {name: archive[name] for name in archive.files}


def together(*parts: Arrays) -> dict[str, npt.NDArray[Any]]:
    """Return the arrays of several mappings in one; DataError if two of them have the same name."""
    _only_once([name for part in parts for name in part], "arrays that are put together")
    return {name: array for part in parts for name, array in part.items()}


def _only_once(names: list[str], where: str) -> None:
    if twice := sorted({name for name in names if names.count(name) > 1}):
        raise DataError(f"{where}: more than one array is called '{twice[0]}'; give each a name of its own")


NEAR_HALF = 1e-6  # Distance from half of the last digit within which exact decimals decide how to round.
TENS = np.array([float(f"1e{exponent}") for exponent in range(23)])
"""The powers of ten that a float holds without error."""
MIN_SIZE, MAX_SIZE = 1e-13, 1e8
"""Numbers between these need no other power of ten to become integers of all significant digits."""


def rounded_array(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return an array with every float rounded as it is in files."""
    if array.dtype.kind != "f":
        return array
    numbers = array.ravel()
    result, known = _quickly_rounded(numbers)
    rest = numbers[~known].astype(float)
    rest[np.abs(rest) < MIN_NORMAL] = 0.0
    result[~known] = (f"%.{SIGNIFICANT_DIGITS}g " * len(rest) % tuple(rest.tolist())).split()
    return result.reshape(array.shape)


def _quickly_rounded(numbers: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], npt.NDArray[np.bool_]]:
    """Return rounded numbers, and which of them are known to be what their text says: most numbers of a body.

    The quotient of two numbers without error is the nearest to the decimal, as is what is read from a text.
    """
    sizes = np.abs(numbers.astype(float))
    usual = (sizes > MIN_SIZE) & (sizes < MAX_SIZE)
    sizes[~usual] = 1.0
    tens = TENS[SIGNIFICANT_DIGITS - 1 - np.floor(np.log10(sizes)).astype(int)]
    scaled = sizes * tens
    digits = np.rint(scaled)
    result = np.copysign(digits / tens, numbers).astype(numbers.dtype)
    are_all = (digits >= TENS[SIGNIFICANT_DIGITS - 1]) & (digits < TENS[SIGNIFICANT_DIGITS])
    return result, usual & are_all & (np.abs(np.abs(scaled - digits) - 0.5) > NEAR_HALF)

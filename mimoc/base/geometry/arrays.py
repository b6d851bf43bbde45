"""Archives of arrays, in which no name may stand for two."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import DataError

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

"""NumPy as an array library by the Python array API standard, with short ways for single infants.

`numpy.take(a, i)` passes a dispatcher that costs more than the reading itself for arrays as small as an infant's;
`a.take(i)` does not. NumPy 1.26 lacks some names of the standard.
"""

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np

NEW_NAMES = {
    "acos": "arccos",
    "asin": "arcsin",
    "atan": "arctan",
    "atan2": "arctan2",
    "concat": "concatenate",
    "permute_dims": "transpose",
    "pow": "power",
}
"""Names of the standard that NumPy has since version 2, with those it has had before."""


def _take(array: np.ndarray, indices: np.ndarray, /, *, axis: int | None = None) -> np.ndarray:
    return array.take(indices, axis)


def _sum(array: np.ndarray, /, *, axis: Any = None, keepdims: bool = False) -> np.ndarray:
    return array.sum(axis, keepdims=keepdims)


def _astype(array: np.ndarray, dtype: Any, /, *, copy: bool = True) -> np.ndarray:
    return array.astype(dtype, copy=copy)


def _matrix_transpose(array: np.ndarray, /) -> np.ndarray:
    return array.swapaxes(-1, -2)


def _vecdot(first: np.ndarray, second: np.ndarray, /) -> np.ndarray:
    return np.matmul(first[..., None, :], second[..., :, None])[..., 0, 0]


def _library() -> Any:
    """Return all public names of NumPy, those of the standard, and the short ways."""
    names = {name: getattr(np, name) for name in np.__all__}
    names |= {name: getattr(np, former) for name, former in NEW_NAMES.items()}
    short = {"take": _take, "sum": _sum, "astype": _astype, "matrix_transpose": _matrix_transpose, "bool": np.bool_}
    names.setdefault("vecdot", _vecdot)  # NumPy 1.26 has none.
    return SimpleNamespace(**names | short)


NUMPY: Any = _library()  # What `Worlds.xp` is on the CPU.


def torch_library(beside: Any) -> tuple[Any, Callable[[Any], Any]]:
    """Return torch by the standard, and what copies NumPy's arrays to the device of a tensor.

    Real numbers get 32 bits there, whole ones 64, as torch indexes.
    """
    import array_api_compat.torch as library  # Comes with `mimoc[gpu]`.
    import torch

    def put(values: Any) -> Any:
        values = np.asarray(values)
        kind = {"f": torch.float32, "b": torch.bool}.get(values.dtype.kind, torch.int64)
        return torch.tensor(values, dtype=kind, device=beside.device)

    return library, put

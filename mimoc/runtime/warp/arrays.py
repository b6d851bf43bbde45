"""Arrays on a device: flat views of MuJoCo Warp's, and what actions come in and observations go out as."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import warp as wp

from mimoc.errors import UnknownNameError


def flat(array: wp.array) -> wp.array:
    """Return the 32-bit numbers of an array as rows, shape (its first axis, the rest), in the same memory."""
    assert array.is_contiguous
    numbers = array.size * wp.types.type_size_in_bytes(array.dtype) // 4
    shape = (array.shape[0], numbers // max(array.shape[0], 1))
    view = wp.array(ptr=array.ptr, dtype=wp.float32, shape=shape, device=array.device)
    view.owner = array  # Which is kept as long as its view.
    return view


def put(values: Any, dtype: Any = wp.float32) -> wp.array:
    """Return a copy of values on Warp's present device."""
    return wp.array(np.ascontiguousarray(values), dtype=dtype)


def taken(values: Any, shape: tuple[int, ...]) -> wp.array:
    """Return an array of 32-bit numbers of any library that knows DLPack, or NumPy's, as one of Warp's.

    Raises:
        ValueError: If it has another shape, or NumPy's is not finite.
    """
    if not isinstance(values, wp.array) and (isinstance(values, (np.ndarray, list, tuple)) or np.isscalar(values)):
        values = np.asarray(values, np.float32)
        if values.shape == shape and not np.isfinite(values).all():
            infant = int(np.flatnonzero(~np.isfinite(values).all(axis=1))[0])
            raise ValueError(f"expected finite actions, got {values[infant].tolist()} for infant {infant}")
    if tuple(values.shape) != shape:
        raise ValueError(f"expected finite actions of shape {shape}, got shape {tuple(values.shape)}")
    if isinstance(values, np.ndarray):
        return wp.array(values, dtype=wp.float32, device="cpu", copy=False)
    return values if isinstance(values, wp.array) else wp.from_dlpack(values)


def _as_torch(array: wp.array) -> Any:
    return wp.to_torch(array)


KINDS: Mapping[str, Callable[[wp.array], Any]] = {
    "numpy": lambda array: array.numpy().copy(),
    "torch": _as_torch,
    "warp": lambda array: array,
}
"""What observations and rewards can be given as: copies for NumPy, else the environment's own memory."""


def giver(arrays: str) -> Callable[[wp.array], Any]:
    """Return what turns an array of Warp's into one of a library.

    Raises:
        UnknownNameError: If it is no such library.
    """
    if arrays not in KINDS:
        raise UnknownNameError("kind of arrays", arrays, KINDS)
    return KINDS[arrays]

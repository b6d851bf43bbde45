"""Seeds and options of a reset, for each of many infants."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

RESET_MASK = "reset_mask"
"""Gymnasium's option that says which environments are reset."""


def seeds_of(seed: int | Sequence[int | None] | None, count: int) -> list[int | None]:
    """Return the seed of each infant: infant i gets `seed + i`, or the i-th of a list.

    Raises:
        ValueError: If a list has another length.
    """
    if seed is None:
        return [None] * count
    if isinstance(seed, (int, np.integer)):
        return [int(seed) + index for index in range(count)]
    if len(seed) != count:
        raise ValueError(f"expected {count} seeds, one for each infant, got {len(seed)}")
    return [None if each is None else int(each) for each in seed]


def options_of(options: Mapping[str, Any] | None, count: int) -> list[dict[str, Any]]:
    """Return the options of each infant.

    A value is that of all infants, unless it is a list, tuple or array: then infant i gets the i-th, and none for None.

    Raises:
        ValueError: If a list has another length.
    """
    found: list[dict[str, Any]] = [{} for _ in range(count)]
    for name, value in (options or {}).items():
        if name == RESET_MASK:
            continue
        values = value if isinstance(value, (list, tuple, np.ndarray)) else [value] * count
        if len(values) != count:
            raise ValueError(f"option '{name}': expected one value for all, or {count}, got {len(values)}")
        for own, each in zip(found, values, strict=True):
            if each is not None:
                own[name] = each.item() if isinstance(each, np.generic) else each
    return found


def chosen(options: Mapping[str, Any] | None, count: int) -> list[int]:
    """Return the infants that are reset: all, or those of the option `reset_mask`, a boolean array of shape (n,).

    Raises:
        ValueError: If it is anything else, or nothing in it is True.
    """
    mask = (options or {}).get(RESET_MASK)
    if mask is None:
        return list(range(count))
    mask = np.asarray(mask)
    if mask.shape != (count,) or mask.dtype != np.bool_ or not mask.any():
        raise ValueError(
            f"option '{RESET_MASK}': expected a boolean array of shape ({count},) with a True, got {mask.dtype} of "
            f"shape {mask.shape}"
        )
    return np.flatnonzero(mask).tolist()

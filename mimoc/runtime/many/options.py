"""Seeds and options of a reset, for each of many infants."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mimoc.random_streams import checked_seed
from mimoc.runtime.growing import options_given

RESET_MASK = "reset_mask"
"""Gymnasium's option that says which environments are reset."""


def seeds_of(seed: int | Sequence[int | None] | None, count: int) -> list[int | None]:
    """Return the seed of each infant: infant i gets `seed + i`, or the i-th of a list.

    Raises:
        ValueError: If a list has another length, or a seed is not a non-negative integer.
    """
    if seed is None:
        return [None] * count
    if not isinstance(seed, (list, tuple, np.ndarray)):
        first = checked_seed(seed)
        return [first + index for index in range(count)]
    if len(seed) != count:
        raise ValueError(f"expected {count} seeds, one for each infant, got {len(seed)}")
    return [None if each is None else checked_seed(each) for each in seed]


def options_of(options: Mapping[str, Any] | None, count: int) -> list[dict[str, Any]]:
    """Return the options of each infant.

    A value is that of all infants, unless it is a list, tuple or array: then infant i gets the i-th, and none for None.

    Raises:
        TypeError: If the options are no dictionary.
        ValueError: If a list has another length.
    """
    found: list[dict[str, Any]] = [{} for _ in range(count)]
    for name, value in options_given(options).items():
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
        TypeError: If the options are no dictionary.
        ValueError: If it is anything else, or nothing in it is True.
    """
    mask = options_given(options).get(RESET_MASK)
    if mask is None:
        return list(range(count))
    mask = np.asarray(mask)
    if mask.shape != (count,) or mask.dtype != np.bool_ or not mask.any():
        raise ValueError(
            f"option '{RESET_MASK}': expected a boolean array of shape ({count},) with a True, got {mask.dtype} of "
            f"shape {mask.shape}"
        )
    return np.flatnonzero(mask).tolist()

"""What Gymnasium's vector environments take and give, for many infants: seeds, options, spaces and infos."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from gymnasium import Space
from gymnasium.spaces import Box, Dict
from gymnasium.vector.utils import batch_differing_spaces, batch_space

from mimoc.random_streams import checked_seed
from mimoc.runtime.growing import options_given

RESET_MASK = "reset_mask"
"""Gymnasium's option that says which environments are reset."""
Infos = dict[int, dict[str, Any]]
"""Of each infant that has one."""
FINAL = "final_obs"
"""What an infant saw last, which is not put into arrays."""


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
    return [None if item is None else checked_seed(item) for item in seed]


def options_of(options: Mapping[str, Any] | None, count: int) -> list[dict[str, Any]]:
    """Return the options of each infant.

    A value is that of all infants, unless it is a list, tuple or array: then infant i gets the i-th, and none for None.

    Raises:
        TypeError: If the options are no dictionary.
        ValueError: If a list has another length.
    """
    options_by_infant: list[dict[str, Any]] = [{} for _ in range(count)]
    for name, value in options_given(options).items():
        if name == RESET_MASK:
            continue
        values = value if isinstance(value, (list, tuple, np.ndarray)) else [value] * count
        if len(values) != count:
            raise ValueError(f"option '{name}': expected one value for all, or {count}, got {len(values)}")
        for of_infant, item in zip(options_by_infant, values, strict=True):
            if item is not None:
                of_infant[name] = item.item() if isinstance(item, np.generic) else item
    return options_by_infant


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


def covering(spaces: Sequence[Dict]) -> Dict:
    """Return the space that holds what any of some infants observes: bounds may depend on strength, and so on age."""
    if all(space == spaces[0] for space in spaces):
        return spaces[0]
    return Dict({name: _covering([space[name] for space in spaces]) for name in spaces[0]})


def batch_of(spaces: Sequence[Dict]) -> Space:
    """Return the space of the observations of all infants, each within its own bounds."""
    if all(space == spaces[0] for space in spaces):
        return batch_space(spaces[0], len(spaces))
    return batch_differing_spaces(list(spaces))


def _covering(spaces: Sequence[Space]) -> Space:
    first = spaces[0]
    if not isinstance(first, Box):
        return first
    boxes = [space for space in spaces if isinstance(space, Box)]
    low, high = np.min([box.low for box in boxes], axis=0), np.max([box.high for box in boxes], axis=0)
    return Box(low, high, dtype=first.dtype.type)


def joined_infos(infos: Infos, count: int) -> dict[str, Any]:
    """Return an array of each value, beside a mask of the infants that have it, for a number of infants.

    It is what `VectorEnv._add_info` makes of them one by one.
    """
    joined: dict[str, Any] = {}
    for name in dict.fromkeys(name for info in infos.values() for name in info):
        having = [infant for infant, info in infos.items() if name in info]
        values = [infos[infant][name] for infant in having]
        if isinstance(values[0], dict) and name != FINAL:
            joined[name] = joined_infos(dict(zip(having, values, strict=True)), count)
        else:
            joined[name] = _array(values, having, count)
        mask = np.zeros(count, bool)
        mask[having] = True
        joined[f"_{name}"] = mask
    return joined


def _array(values: list[Any], having: list[int], count: int) -> np.ndarray:
    """Return the values of some infants in an array of all, of the type that is theirs."""
    first = values[0]
    if isinstance(first, (bool, int, float, np.number)):
        array = np.zeros(count, type(first))
        array[having] = values
    elif isinstance(first, np.ndarray):
        array = np.zeros((count, *first.shape), first.dtype)
        array[having] = values
    else:
        array = np.full(count, None, object)
        for infant, value in zip(having, values, strict=True):
            array[infant] = value
    return array

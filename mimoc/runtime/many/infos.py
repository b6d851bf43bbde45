"""The `info` of many infants, as Gymnasium's vector environments give it."""

from typing import Any

import numpy as np

Infos = dict[int, dict[str, Any]]
"""Of each infant that has one."""
FINAL = "final_obs"
"""What an infant saw last, which is not put into arrays."""


def joined(infos: Infos, count: int) -> dict[str, Any]:
    """Return an array of each value, beside a mask of the infants that have it, for a number of infants.

    It is what `VectorEnv._add_info` makes of them one by one.
    """
    found: dict[str, Any] = {}
    for name in dict.fromkeys(name for info in infos.values() for name in info):
        having = [infant for infant, info in infos.items() if name in info]
        values = [infos[infant][name] for infant in having]
        if isinstance(values[0], dict) and name != FINAL:
            found[name] = joined(dict(zip(having, values, strict=True)), count)
        else:
            found[name] = _array(values, having, count)
        mask = np.zeros(count, bool)
        mask[having] = True
        found[f"_{name}"] = mask
    return found


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

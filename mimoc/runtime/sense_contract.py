"""What senses and tasks must return: arrays of the shapes and types that their spaces say, of numbers that are there.

A plug-in, or an object of a script, is held to this where an environment first senses, and not after that.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium import Space
from gymnasium.spaces import Box

from mimoc.base.errors import KindError
from mimoc.runtime.sense import Sense, Vector

KINDS = {"f": "real", "i": "whole", "u": "whole", "b": "truth"}
"""Types of arrays, by NumPy's letter, that are cast without a word."""


def check_sense(name: str, sense: Sense, sample: Any) -> None:
    """Check a first sample of a sense, with what its organ and its noise make of it, and what is observed of that."""
    what = f"sense '{name}' ({sense.class_name})"
    if isinstance(sense, Vector):
        check_numbers(f"{what}: its sample", sample, (len(sense.layout),), np.float64)
    check_observation(what, sense.observe(sample), sense.spaces)


def check_observation(what: str, observed: Any, spaces: Mapping[str, Space[Any]]) -> None:
    """Check what a sense or a task observes; *what* names it with its class."""
    if not isinstance(observed, Mapping) or observed.keys() != spaces.keys():
        given = ", ".join(map(str, observed)) if isinstance(observed, Mapping) else f"{observed!r:.60}"
        raise KindError(f"{what}: observe() returns {given or 'nothing'}; expected {', '.join(spaces) or 'nothing'}")
    for name, space in spaces.items():
        if isinstance(space, Box):
            check_numbers(
                f"{what}: '{name}' in its observation", observed[name], space.shape, space.dtype, exactly=True
            )
        elif not space.contains(observed[name]):
            raise KindError(f"{what}: '{name}' in its observation is {told(observed[name])}; expected one of {space}")


def check_rows(what: str, given: Any, infants: int) -> None:
    """Check that something is an array with a row for each infant."""
    if np.shape(given)[:1] != (infants,):
        raise KindError(f"{what} returns {told(given)}; expected an array of shape ({infants}, ...): one row an infant")


def check_numbers(what: str, given: Any, shape: tuple[int, ...], dtype: Any, *, exactly: bool = False) -> None:
    """Check that something is an array of a shape, and of a type, or unless *exactly* of another precision of it."""
    dtype, expected = np.dtype(dtype), f"expected an array of {np.dtype(dtype)}, shape {shape}"
    try:
        array = np.asarray(given)
    except ValueError:  # Lists of different lengths.
        array = np.asarray(None)
    is_type = array.dtype == dtype if exactly else KINDS.get(array.dtype.kind) == KINDS[dtype.kind]
    if array.shape != shape or not is_type:
        raise KindError(f"{what} is {told(given)}; {expected}")
    if np.isnan(array).any():
        raise KindError(f"{what} has a NaN; {expected}, with numbers only")


def told(value: Any) -> str:
    """Return in a few words what a value is, for an error."""
    if isinstance(value, (np.ndarray, np.generic)):
        return f"an array of {value.dtype}, shape {value.shape}"
    return f"{value!r:.60}"

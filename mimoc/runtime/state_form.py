"""The form of an environment's state: whether one that comes from anywhere can be that of this environment."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

MAY_BE_NOTHING = ("signals.commands",)
"""Where `None` is nothing yet on its way to the actuators."""
OWN_FORM = ("task", "noise.channels")
"""What checks itself where it is restored, or remembers another number of things at different times."""


@contextmanager
def checked_state(state: Any, own: Mapping[str, Any]) -> Iterator[None]:
    """Restore a state within, that has the form of the present one: the same names and arrays, and only finite numbers.

    Raises:
        ValueError: If it has not; the message says where. Or if it cannot be restored.
    """
    _check(state, own, "")
    try:
        yield
    except (AttributeError, IndexError, KeyError, OverflowError, TypeError) as error:
        raise ValueError(f"this state cannot be restored ({error}); give one that get_state returned") from error


def _check(given: Any, own: Any, where: str) -> None:
    if where in OWN_FORM or (given is None and where.startswith(MAY_BE_NOTHING)):
        return
    if isinstance(own, Mapping):
        _check_mapping(given, own, where)
    elif isinstance(own, np.ndarray):
        _check_array(given, own, where)
    elif isinstance(own, (list, tuple)):
        _check_sequence(given, own, where)
    elif isinstance(own, (bool, str)) or own is None:
        _demand(own is None or type(given) is type(own), where, given)
    elif isinstance(own, (int, np.integer)):
        _demand(isinstance(given, (int, np.integer)) and not isinstance(given, bool), where, given)
    else:
        is_time = isinstance(given, (int, float, np.floating)) and given < math.inf  # -inf: never yet.
        _demand(bool(is_time), where, given)


def _check_mapping(given: Any, own: Mapping[str, Any], where: str) -> None:
    _demand(isinstance(given, Mapping), where, given)
    for name in own:
        inner = f"{where}.{name}".lstrip(".")
        _demand(name in given, inner, "nothing")
        _check(given[name], own[name], inner)


def _check_sequence(given: Any, own: Sequence[Any], where: str) -> None:
    _demand(isinstance(given, (list, tuple)) and len(given) == len(own), where, given)
    for each, like in zip(given, own, strict=True):
        _check(each, like, where)


def _check_array(given: Any, own: np.ndarray, where: str) -> None:
    if not isinstance(given, np.ndarray) or (given.shape, given.dtype) != (own.shape, own.dtype):
        raise ValueError(
            f"state does not fit this infant, it may be of another: {where} is {_told(given)}, expected {_told(own)}"
        )
    if given.dtype.kind == "f" and not np.isfinite(given).all():
        raise ValueError(f"state cannot be restored: {where} has a NaN or an infinity")


def _demand(is_so: bool, where: str, given: Any) -> None:
    if not is_so:
        raise ValueError(
            f"this is not a state of an environment: {f'{where} is ' if where else ''}{_told(given)}; give one that"
            " get_state returned"
        )


def _told(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype}, shape {value.shape}"
    text = value if isinstance(value, str) else repr(value)
    return text if len(text) <= 40 else f"{text[:40]}..."

"""The form of an environment's state: whether one that comes from anywhere can be that of this environment."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np

ON_THE_WAY = "signals."
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
    elif own is None:
        _demand(given is None or (isinstance(given, np.ndarray) and given.dtype.kind in "fiub"), where, given)
    elif isinstance(own, (bool, str)):
        _demand(type(given) is type(own), where, given)
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
    _demand(isinstance(given, (list, tuple)), where, given)
    if any(isinstance(each, tuple) for each in (*given, *own)):
        _check_numbered(given, own, where)
        return
    if where.startswith(ON_THE_WAY) and (not own or isinstance(own[0], np.ndarray)):
        own = [own[0] if own else None] * len(given)  # With a delay that varies, more or fewer are on their way.
    _demand(len(given) == len(own), where, given)
    for each, like in zip(given, own, strict=True):
        _check(each, like, where)


def _check_numbered(given: Sequence[Any], own: Sequence[Any], where: str) -> None:
    """Check what is on its way with a delay that varies: as many numbered signals, or places for them, as there are."""
    like = next((signal for _, signal in own if signal is not None), None)
    for each in given:
        _demand(isinstance(each, tuple) and len(each) == 2 and isinstance(each[0], int), where, each)
        if each[1] is not None and like is not None:
            _check(each[1], like, where)


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

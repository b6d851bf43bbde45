"""The form of states: whether one that comes from anywhere has that of another."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt


def check_form(given: Any, expected: Any, where: str = "") -> None:
    """Check that a state, or something in it, has the form of another: the same names and arrays, and finite numbers.

    Names that *expected* leaves out are not looked at; *where* are the names that lead to it.

    Raises:
        ValueError: If it has another form.
    """
    if isinstance(expected, dict):
        require(isinstance(given, dict), where, given)
        for name in expected:
            inner = f"{where}.{name}".lstrip(".")
            require(name in given, inner, "nothing")
            check_form(given[name], expected[name], inner)
    elif isinstance(expected, (list, tuple)):
        for item, like in zip(checked_list(given, where, len(expected)), expected, strict=True):
            check_form(item, like, where)
    elif isinstance(expected, np.ndarray):
        if not isinstance(given, np.ndarray) or (given.shape, given.dtype) != (expected.shape, expected.dtype):
            raise ValueError(
                f"state does not fit this infant, it may be of another: {where} is {_told(given)}, "
                f"expected {_told(expected)}"
            )
        check_finite(given, where)
    else:
        require(_is_like(given, expected), where, given)


def checked_list(given: Any, where: str, length: int | None = None) -> Sequence[Any]:
    """Return what is there, or raise a ValueError unless it is a list, of this length if it is said."""
    require(isinstance(given, (list, tuple)) and length in (None, len(given)), where, given)
    return given


def require(is_so: bool, where: str, given: Any) -> None:
    """Raise a ValueError that tells what is wrong in a state and where, unless all is well."""
    if not is_so:
        raise ValueError(
            f"this is not a state of an environment: {f'{where} is ' if where else ''}{_told(given)}; give one that"
            " get_state returned"
        )


def _is_like(given: Any, expected: Any) -> bool:
    if expected is None or isinstance(expected, (bool, str)):
        return type(given) is type(expected)
    if isinstance(expected, (int, np.integer)):
        return isinstance(given, (int, np.integer)) and not isinstance(given, bool)
    return isinstance(given, (int, float, np.floating)) and bool(given < math.inf)  # -inf: a time that never was.


def check_finite(given: npt.NDArray[Any], where: str) -> None:
    """Raise a ValueError if an array of a state has a NaN or an infinity."""
    if given.dtype.kind in "fc" and not np.isfinite(given).all():
        raise ValueError(f"state cannot be restored: {where} has a NaN or an infinity")


def _told(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype}, shape {value.shape}"
    text = value if isinstance(value, str) else repr(value)
    return text if len(text) <= 40 else f"{text[:40]}..."

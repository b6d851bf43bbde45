"""Numbers and plain data as they stand in files: the one place where floats are rounded."""

import json
import math
import sys
from collections.abc import Mapping
from json.encoder import encode_basestring
from typing import Any

MIN_NORMAL = sys.float_info.min
SIGNIFICANT_DIGITS = 9  # Enough for any body (a nanometre on a metre), too few to show in which order sums were taken.

MAX_DECIMALS = 6  # Decimals of numbers that people read; a smaller number counts as 0.


def significant(value: float, digits: int) -> float:
    """Return a number rounded to some significant digits."""
    return float(f"{value:.{digits}g}")


def readable(value: float, digits: int = 3) -> str:
    """Return a number as people read it: some significant digits, never an exponent, at most six decimals.

    Digits before the point are all shown; `-` stands for what is no number.

    Example:
        >>> readable(0.000016271), readable(0.25), readable(123456.7), readable(float("nan"))
        ('0.000016', '0.25', '123457', '-')
    """
    if not math.isfinite(value):
        return "-"
    size = math.floor(math.log10(abs(value))) if value else 0
    decimals = min(max(digits - 1 - size, 0), MAX_DECIMALS)
    text = f"{round(value, decimals) + 0.0:.{decimals}f}"  # The sum turns -0.0 into 0.
    return text.rstrip("0").rstrip(".") if "." in text else text


def rounded(data: Any) -> Any:
    """Return plain data with every float rounded as it is in files."""
    if isinstance(data, float):
        return _rounded(data)
    if isinstance(data, (list, tuple)):
        return [rounded(item) for item in data]
    if not isinstance(data, str) and isinstance(data, Mapping):  # The latter takes longer to tell.
        return {key: rounded(value) for key, value in data.items()}
    return data


def _rounded(number: float) -> float:
    return 0.0 if -MIN_NORMAL < number < MIN_NORMAL else float(f"{number:.{SIGNIFICANT_DIGITS}g}")


def render_json(data: Any, levels: int = 99) -> bytes:
    """Return *data* as JSON with sorted keys and rounded numbers, a list of numbers on one line.

    What lies deeper than some levels is on one line. It takes a third of the time of `json.dumps` with an indent, on
    which a build would spend most of its time.

    Raises:
        ValueError: If a number is infinite or not a number.
    """
    return f"{_json(data, levels)}\n".encode()


def _json(data: Any, levels: int, margin: str = "\n") -> str:
    if isinstance(data, str):
        return encode_basestring(data)
    if isinstance(data, float):
        if not math.isfinite(data):
            raise ValueError(f"{data} is not JSON compliant")
        return repr(_rounded(data))
    if type(data) is int:  # Most of what a build writes.
        return repr(data)
    if levels == 0:
        margin, inner, between = "", "", ", "
    else:
        inner = f"{margin} "
        between, levels = f",{inner}", levels - 1
    if isinstance(data, (dict, Mapping)):  # Asking for a dict first saves the time of asking for an abstract class.
        items = [f"{encode_basestring(key)}: {_json(data[key], levels, inner)}" for key in sorted(data)]
        return f"{{{inner}{between.join(items)}{margin}}}" if items else "{}"
    if isinstance(data, (list, tuple)):
        if not data or (type(data[0]) in {float, int} and {float, int}.issuperset(map(type, data))):
            return f"[{', '.join([_json(item, 0) for item in data])}]"
        return f"[{inner}{between.join([_json(item, levels, inner) for item in data])}{margin}]"
    return json.dumps(data)

"""Plain data as JSON: sorted keys, rounded numbers, a list of numbers on one line."""

import json
import math
from collections.abc import Mapping
from json.encoder import encode_basestring
from typing import Any

from mimoc.base.rounding import num

NUMBERS = {float, int}


def render_json(data: Any, levels: int = 99) -> bytes:
    """Return *data* as JSON with sorted keys and rounded numbers, a list of numbers on one line.

    It takes a third of the time of `json.dumps` with an indent, on which a build would spend most of its time.

    Args:
        data: The data.
        levels: What lies deeper in it is on one line.

    Raises:
        ValueError: If a number is infinite or not a number.
    """
    return f"{_json(data, levels)}\n".encode()


def _json(data: Any, levels: int, margin: str = "\n") -> str:
    """Return the JSON of *data*; *margin* begins each line."""
    if isinstance(data, str):
        return encode_basestring(data)
    if isinstance(data, float):
        return _json_number(data)
    if levels == 0:
        margin, inner, between = "", "", ", "
    else:
        inner = f"{margin} "
        between, levels = f",{inner}", levels - 1
    if isinstance(data, (dict, Mapping)):  # Asking for a dict first saves the time of asking for an abstract class.
        items = [f"{encode_basestring(key)}: {_json(data[key], levels, inner)}" for key in sorted(data)]
        return f"{{{inner}{between.join(items)}{margin}}}" if items else "{}"
    if isinstance(data, (list, tuple)):
        if not data or (type(data[0]) in NUMBERS and NUMBERS.issuperset(map(type, data))):
            return f"[{', '.join([_json(item, 0) for item in data])}]"
        return f"[{inner}{between.join([_json(item, levels, inner) for item in data])}{margin}]"
    return json.dumps(data)


def _json_number(number: float) -> str:
    if not math.isfinite(number):
        raise ValueError(f"{number} is not JSON compliant")
    return repr(float(num(number)))

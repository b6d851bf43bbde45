"""Plain data as JSON: sorted keys, rounded numbers, a list of numbers on one line."""

import json
import re
from collections.abc import Mapping
from typing import Any

from mimoc.rounding import rounded

_NUMBERS = re.compile(r"\[\n([-+.,\d\seE]+)\]")
"""A list of numbers as JSON spreads it over lines; no text in JSON has line breaks."""


def render_json(data: Any) -> bytes:
    """Return *data* as JSON with sorted keys and rounded numbers, a list of numbers on one line."""
    return f"{_json(data)}\n".encode()


def json_members(data: Mapping[str, Any]) -> dict[str, str]:
    """Return the text of each member of an object in JSON, for `join_json`: it can be kept while others change."""
    return {key: _json({key: value})[2:-2] for key, value in data.items()}


def join_json(members: Mapping[str, str]) -> bytes:
    """Return the object that some members make, as `render_json` would have it."""
    return "{{\n{}\n}}\n".format(",\n".join(members[key] for key in sorted(members))).encode()


def _json(data: Any) -> str:
    text = json.dumps(rounded(data), indent=1, sort_keys=True, ensure_ascii=False, allow_nan=False)
    return _NUMBERS.sub(lambda numbers: f"[{' '.join(numbers[1].split())}]", text)

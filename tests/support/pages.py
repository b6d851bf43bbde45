"""Reading pages of `mimoc view`, as the program in them does."""

import base64
import gzip
import json
import re
from typing import Any
from unittest.mock import patch

import numpy as np

from mimoc.viewer.encoding import FINE_M

FEW_AGES_MONTHS = (0.0, 9.0, 24.0)


def few_ages() -> Any:
    """Let pages have three ages only, in a `with` block, which takes a tenth of the time."""
    return patch.multiple("mimoc.viewer.page", AGES_MONTHS=FEW_AGES_MONTHS, SKIN_AGES_MONTHS=FEW_AGES_MONTHS)


def read_page(page: str) -> dict[str, Any]:
    data = json.loads(_text(page, "data"))
    block = gzip.decompress(base64.b64decode(_text(page, "block")))
    arrays = [_array(block, **described) for described in data.pop("arrays")]
    return _with_arrays(data, arrays)


def at_age(ages_months: list[float], values: np.ndarray, age_months: float) -> np.ndarray:
    """Return values at an age: straight lines between the ages that there are."""
    after = int(np.clip(np.searchsorted(ages_months, age_months), 1, len(ages_months) - 1))
    one, other = ages_months[after - 1], ages_months[after]
    share = (age_months - one) / (other - one)
    return values[after - 1] + share * (values[after] - values[after - 1])


def places_of(steps: np.ndarray) -> np.ndarray:
    """Return the places, in [m], shape (ages, n, 3), of what `steps_of` returns."""
    low, high = steps.astype(np.int64)
    whole = np.cumsum(low + 256 * high, axis=0).astype(np.uint16).astype(np.int16)
    return np.moveaxis(whole, 1, -1) * FINE_M


def _text(page: str, name: str) -> str:
    (found,) = re.findall(rf'<script type="[^"]*" id="{name}">(.*?)</script>', page, re.DOTALL)
    return found


def _array(block: bytes, at: int, kind: str, shape: list[int]) -> np.ndarray:
    return np.frombuffer(block, f"<{kind}", count=int(np.prod(shape)), offset=at).reshape(shape)


def _with_arrays(value: Any, arrays: list[np.ndarray]) -> Any:
    if isinstance(value, list):
        return [_with_arrays(each, arrays) for each in value]
    if not isinstance(value, dict):
        return value
    if "array" in value:
        found = arrays[value["array"]]
        return places_of(found) if "unit" in value else found
    return {key: _with_arrays(each, arrays) for key, each in value.items()}


def wait_for(page: Any, condition: str) -> None:
    """Wait until a condition holds; Playwright's own way makes functions of text, which pages forbid themselves."""
    page.evaluate(f"(async () => {{ while (!({condition})) await new Promise((next) => setTimeout(next, 20)); }})()")

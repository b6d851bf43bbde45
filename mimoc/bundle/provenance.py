"""The provenance of a bundle as it stands in its file, where what many numbers share is written once, and as read.

`phrases` are parts of rules, and places in MJCF, in which `'*'` is the name in the key of a number; `sources` are lists
of keys, in which `*` is that name. What is said of numbers is in `origins`: `rule` are the phrases that it consists of,
`xml` is a phrase and `from` one of these lists, by their indices. In `numbers`, by what stands before the last dot of
a key and what stands after it, a number is the index of its origin, its value, and what is said of it alone.
"""

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from graphlib import CycleError, TopologicalSorter
from typing import Any

from mimoc.base.errors import BundleError

Entry = dict[str, Any]  # Value, rule, data and sources of a number.
Entries = Mapping[str, Mapping[str, Any]]  # Value, rule, data and sources of each number, by key.
PROVENANCE = "provenance.json"
MAX_FOLLOWED = 8
"""Number of sources that are explained recursively; of more, such as the masses of all bodies, only the values."""
MAX_EXPLAINED = 100_000  # Numbers that one explanation can consist of.
NUMBERS, ORIGINS, PHRASES, SOURCES = "numbers", "origins", "phrases", "sources"
ALONE = ("fit", "points")  # What hardly two numbers share.
MAX_UNPACKED = 50_000_000
"""Characters and keys that all numbers can have together; the largest bundles have a twentieth of this."""
BETWEEN_PHRASES = re.compile(r"(?<=[;:,]) | (?=x \d)")  # Factors are what most rules differ in.


def packed(entries: Mapping[str, Entry]) -> dict[str, Any]:
    """Return the provenance of numbers, by key, as it is written."""
    phrases = dict[str, int]()
    sources = dict[tuple[str, ...], int]()
    origins = dict[str, int]()
    numbers = dict[str, dict[str, Any]]()
    for key in sorted(entries):
        origin = dict(entries[key])
        origin["rule"] = [_index(phrases, part) for part in BETWEEN_PHRASES.split(origin["rule"])]
        if "from" in origin:
            origin["from"] = _index(
                sources, tuple(source.replace(f".{_name(key)}.", ".*.") for source in origin["from"])
            )
        if "xml" in origin:
            origin["xml"] = _index(phrases, origin["xml"].replace(f"'{_name(key)}'", "'*'"))
        value = origin.pop("value")
        alone = {name: origin.pop(name) for name in ALONE if name in origin}
        of, _, what = key.rpartition(".")
        index = _index(origins, json.dumps(origin, sort_keys=True))
        numbers.setdefault(of, {})[what] = [index, value, alone] if alone else [index, value]
    return {NUMBERS: numbers, ORIGINS: list(map(json.loads, origins)), PHRASES: list(phrases), SOURCES: list(sources)}


def unpacked(written: Mapping[str, Any]) -> dict[str, Entry]:
    """Return the provenance of numbers, by key, from what is written; a ValueError says that it would be too large."""
    phrases, sources = written[PHRASES], written[SOURCES]
    numbers = _numbers(written[NUMBERS], written[ORIGINS])
    if _size(numbers.values(), phrases, sources) > MAX_UNPACKED:
        raise ValueError("more text than any infant needs")
    read: dict[str, Callable[[Any, str], Any]] = {
        "rule": lambda parts, key: " ".join(phrases[part] for part in parts),
        "from": lambda index, key: [source.replace(".*.", f".{_name(key)}.") for source in sources[index]],
        "xml": lambda index, key: phrases[index].replace("'*'", f"'{_name(key)}'"),
    }
    return {
        key: {name: read[name](value, key) if name in read else value for name, value in entry.items()}
        for key, entry in numbers.items()
    }


def _numbers(written: Mapping[str, Mapping[str, Any]], origins: Sequence[Entry]) -> dict[str, Entry]:
    """Return what is said of each number, by key, with indices of phrases and sources."""
    return {
        f"{of}.{what}" if of else what: {**origins[index], "value": value, **(alone[0] if alone else {})}
        for of, numbers in written.items()
        for what, (index, value, *alone) in numbers.items()
    }


def _size(numbers: Iterable[Entry], phrases: Sequence[str], sources: Sequence[Any]) -> int:
    size = 0
    for entry in numbers:
        size += sum(len(phrases[part]) for part in entry["rule"])
        size += len(sources[entry["from"]]) if "from" in entry else 0
        size += len(phrases[entry["xml"]]) if "xml" in entry else 0
    return size


def _index(indices: dict[Any, int], value: Any) -> int:
    return indices.setdefault(value, len(indices))


def _name(key: str) -> str:
    """Return what the second part of a key names: `head` in `geom.head.size`."""
    return key.partition(".")[2].rpartition(".")[0]


@lru_cache(maxsize=2)
def read_entries(content: bytes) -> Entries:
    """Return the provenance in a file, the same object for the last files, or raise a BundleError if it is damaged."""
    try:
        entries = unpacked(json.loads(content))
        if not isinstance(entries, dict) or not all(map(_is_entry, entries.values())):
            raise ValueError("an entry is incomplete")
        sizes = dict[str, int]()
        for key in TopologicalSorter({key: entry.get("from", ()) for key, entry in entries.items()}).static_order():
            sources = entries[key].get("from", ())
            sizes[key] = 1 + (sum(sizes[source] for source in sources) if len(sources) <= MAX_FOLLOWED else 0)
        if max(sizes.values(), default=0) > MAX_EXPLAINED:
            raise ValueError("an explanation without end")
    except (ValueError, LookupError, TypeError, AttributeError, CycleError, RecursionError):
        raise BundleError(f"its {PROVENANCE} is damaged; build it again with 'mimoc build'") from None
    return entries


def _is_entry(entry: Any) -> bool:
    if not isinstance(entry, dict) or "value" not in entry or not isinstance(entry.get("rule"), str):
        return False
    texts = [entry.get("unit", ""), entry.get("xml", "")]
    points = entry.get("points", [])
    fit = entry.get("fit", {})
    return (
        all(isinstance(text, str) for text in texts)
        and isinstance(entry.get("from", []), list)
        and isinstance(fit, dict)
        and isinstance(points, list)
        and all(map(_is_point, points))
    )


def _is_point(point: Any) -> bool:
    if not isinstance(point, dict) or "origin" not in point:
        return False
    return all(isinstance(point.get(name), (int, float)) for name in ("age_months", "value_cm"))

"""The provenance of a bundle as it stands in its file, where what many numbers share is written once, and as read.

`phrases` are parts of rules, and places in MJCF, in which `'*'` is the name in the key of a number; `sources` are lists
of keys, in which `*` is that name. In `numbers`, `rule` are the phrases that it consists of, `xml` is a phrase and
`from` one of these lists, by their indices.
"""

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from graphlib import CycleError, TopologicalSorter
from typing import Any

from mimoc.base.errors import BundleError

Entry = dict[str, Any]
"""Value, rule, data and sources of a number."""
Entries = Mapping[str, Mapping[str, Any]]
"""Value, rule, data and sources of each number, by key."""
PROVENANCE = "provenance.json"
MOST_FOLLOWED = 8
"""Number of sources that are explained recursively; of more, such as the masses of all bodies, only the values."""
MOST_EXPLAINED = 100_000
"""Numbers that one explanation can consist of."""
NUMBERS, PHRASES, SOURCES = "numbers", "phrases", "sources"
MOST_UNPACKED = 50_000_000
"""Characters and keys that all numbers can have together; the largest bundles have a twentieth of this."""
BETWEEN_PHRASES = re.compile(r"(?<=[;:,]) | (?=x \d)")
"""Factors are what most rules differ in."""


def packed(entries: Mapping[str, Entry]) -> dict[str, Any]:
    """Return the provenance of numbers, by key, as it is written."""
    phrases, sources = dict[str, int](), dict[tuple[str, ...], int]()
    numbers = {}
    for key in sorted(entries):
        entry = dict(entries[key])
        entry["rule"] = [_index(phrases, part) for part in BETWEEN_PHRASES.split(entry["rule"])]
        if "from" in entry:
            entry["from"] = _index(sources, tuple(source.replace(f".{_name(key)}.", ".*.") for source in entry["from"]))
        if "xml" in entry:
            entry["xml"] = _index(phrases, entry["xml"].replace(f"'{_name(key)}'", "'*'"))
        numbers[key] = entry
    return {NUMBERS: numbers, PHRASES: list(phrases), SOURCES: list(sources)}


def unpacked(written: Mapping[str, Any]) -> dict[str, Entry]:
    """Return the provenance of numbers, by key, from what is written; older bundles have it as it is.

    Raises:
        ValueError: If it would be far larger than any. What is written may also lack what it refers to.
    """
    if NUMBERS not in written:
        return dict(written)
    phrases, sources = written[PHRASES], written[SOURCES]
    if _size(written[NUMBERS].values(), phrases, sources) > MOST_UNPACKED:
        raise ValueError("more text than any infant needs")
    read: dict[str, Callable[[Any, str], Any]] = {
        "rule": lambda parts, key: " ".join(phrases[part] for part in parts),
        "from": lambda index, key: [source.replace(".*.", f".{_name(key)}.") for source in sources[index]],
        "xml": lambda index, key: phrases[index].replace("'*'", f"'{_name(key)}'"),
    }
    return {
        key: {name: read[name](value, key) if name in read else value for name, value in entry.items()}
        for key, entry in written[NUMBERS].items()
    }


def _size(numbers: Iterable[Entry], phrases: Sequence[str], sources: Sequence[Any]) -> int:
    """Return how many characters and keys it takes to write each number by itself."""
    size = 0
    for entry in numbers:
        size += sum(len(phrases[part]) for part in entry["rule"])
        size += len(sources[entry["from"]]) if "from" in entry else 0
        size += len(phrases[entry["xml"]]) if "xml" in entry else 0
    return size


def _index(indices: dict[Any, int], value: Any) -> int:
    """Return the index of a value among those that were asked for so far, to which it is added."""
    return indices.setdefault(value, len(indices))


def _name(key: str) -> str:
    """Return what the second part of a key names: `head` in `geom.head.size`."""
    return key.partition(".")[2].rpartition(".")[0]


@lru_cache(maxsize=2)
def read_entries(content: bytes) -> Entries:
    """Return the provenance that a file contains, the same object again for the last files that were asked for.

    Raises:
        BundleError: If it is damaged: an entry is missing or incomplete, or one is made from itself.
    """
    try:
        entries = unpacked(json.loads(content))
        if not isinstance(entries, dict) or not all(map(_is_entry, entries.values())):
            raise ValueError("an entry is incomplete")
        sizes = dict[str, int]()
        for key in TopologicalSorter({key: entry.get("from", ()) for key, entry in entries.items()}).static_order():
            sources = entries[key].get("from", ())
            sizes[key] = 1 + (sum(sizes[source] for source in sources) if len(sources) <= MOST_FOLLOWED else 0)
        if max(sizes.values(), default=0) > MOST_EXPLAINED:
            raise ValueError("an explanation without end")
    except (ValueError, LookupError, TypeError, AttributeError, CycleError, RecursionError):
        raise BundleError(f"its {PROVENANCE} is damaged; build it again with 'mimoc build'") from None
    return entries


def _is_entry(entry: Any) -> bool:
    """Return whether data says what is said of every number."""
    if not isinstance(entry, dict) or "value" not in entry or not isinstance(entry.get("rule"), str):
        return False
    texts, points, fit = [entry.get("unit", ""), entry.get("xml", "")], entry.get("points", []), entry.get("fit", {})
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

"""The provenance of a bundle as it stands in its file, where what many numbers share is written once.

`phrases` are parts of rules, and places in MJCF, in which `'*'` is the name in the key of a number; `sources` are lists
of keys. In `numbers`, `rule` are the phrases that it consists of, `xml` is a phrase and `from` one of these lists, by
their indices.
"""

import re
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from typing import Any

from mimoc.body.origins import Entry

NUMBERS, PHRASES, SOURCES = "numbers", "phrases", "sources"
MOST_UNPACKED = 50_000_000
"""Characters and keys that all numbers can have together; the largest bundles have a twentieth of this."""
BETWEEN_PHRASES = re.compile(r"(?<=[;:,]) | (?=x \d)")
"""Factors are what most rules differ in."""


def packed(entries: Mapping[str, Entry]) -> dict[str, Any]:
    """Return the provenance of numbers, by key, as it is written."""
    phrases, sources = _Table(), _Table()
    numbers = {}
    for key in sorted(entries):
        entry = dict(entries[key])
        entry["rule"] = [phrases.index(part) for part in BETWEEN_PHRASES.split(entry["rule"])]
        if "from" in entry:
            entry["from"] = sources.index(tuple(entry["from"]))
        if "xml" in entry:
            entry["xml"] = phrases.index(entry["xml"].replace(f"'{_name(key)}'", "'*'"))
        numbers[key] = entry
    return {NUMBERS: numbers, PHRASES: phrases.values, SOURCES: sources.values}


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
        "from": lambda index, key: list(sources[index]),
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


class _Table:
    """Values, each once, in the order in which they are first asked for."""

    def __init__(self):
        self._indices: dict[Hashable, int] = {}

    def index(self, value: Hashable) -> int:
        return self._indices.setdefault(value, len(self._indices))

    @property
    def values(self) -> list[Any]:
        return list(self._indices)


def _name(key: str) -> str:
    """Return what the second part of a key names: `head` in `geom.head.size`."""
    return key.partition(".")[2].rpartition(".")[0]

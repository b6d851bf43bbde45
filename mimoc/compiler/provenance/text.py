"""The provenance of a bundle, read from its file."""

import json
from collections.abc import Mapping
from functools import lru_cache
from graphlib import CycleError, TopologicalSorter
from typing import Any

from mimoc.compiler.provenance.packing import unpacked
from mimoc.errors import BundleError

Entries = Mapping[str, Mapping[str, Any]]
"""Value, rule, data and sources of each number, by key."""
PROVENANCE = "provenance.json"
MOST_FOLLOWED = 8
"""Number of sources that are explained recursively; of more, such as the masses of all bodies, only the values."""
MOST_EXPLAINED = 100_000
"""Numbers that one explanation can consist of."""


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

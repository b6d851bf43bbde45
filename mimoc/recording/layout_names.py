"""Names of many numbers in few words: `hip 0 x [N]`, `hip 0 y [N]` ... as one run for each part of the body."""

import re
from collections.abc import Mapping, Sequence
from itertools import groupby, takewhile
from typing import Any

NUMBERED = re.compile(r"^(.*?)(\d+)(\D*)$")
MOST = 5_000_000
"""Names of all numbers of an observation; the densest skins have a tenth."""
LONG = 100
"""Layouts of fewer names are written out."""


def compact_names(layout: Sequence[str]) -> list[Any]:
    """Return a layout as it stands in files: names, or runs `{"name", "from", "to", "ends"}` of numbered names."""
    if len(layout) < LONG:
        return list(layout)
    items: list[Any] = []
    for prefix, names in groupby(layout, key=_prefix):
        run = list(names)
        short = None if prefix is None else _run(prefix, run)
        items += run if short is None else [short]
    return items


def expand_names(layout: Sequence[Any]) -> tuple[str, ...]:
    """Return the names of a layout as it stands in files."""
    if sum(1 if isinstance(item, str) else _count(item) for item in layout) > MOST:
        raise ValueError("a layout of more numbers than any infant has")
    return tuple(name for item in layout for name in ([item] if isinstance(item, str) else _names(item)))


def _prefix(name: str) -> str | None:
    match = NUMBERED.match(name)
    return match and match[1]


def _run(prefix: str, names: Sequence[str]) -> dict[str, Any] | None:
    """Return a run that says all names, or None if there is none."""
    parts = [match for name in names if (match := NUMBERED.match(name))]
    first = parts[0][2]
    ends = [part[3] for part in takewhile(lambda part: part[2] == first, parts)]
    run = {"name": prefix, "from": int(first), "to": int(parts[-1][2]), "ends": ends}
    return run if _names(run) == list(names) else None


def _count(run: Mapping[str, Any]) -> int:
    return max(0, run["to"] + 1 - run["from"]) * len(run["ends"])


def _names(run: Mapping[str, Any]) -> list[str]:
    numbers = range(run["from"], run["to"] + 1)
    return [f"{run['name']}{number}{end}" for number in numbers for end in run["ends"]]

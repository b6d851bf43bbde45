"""Explanation of the numbers of a bundle, from the XML attribute back to the table row."""

import re
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from fnmatch import fnmatchcase
from typing import Any

from mimoc.base.errors import BundleError, MimocError
from mimoc.bundle.io import Bundle
from mimoc.bundle.provenance import MAX_FOLLOWED, PROVENANCE, Entries, read_entries
from mimoc.bundle.world import WorldBundle
from mimoc.compiler.building import builder
from mimoc.compiler.provenance import SPEC_FILE
from mimoc.schema.infant import read_spec
from mimoc.schema.source import parse

CERTAINTIES: Mapping[str, str] = {
    "S": "read in the source",
    "M": "known from memory, not checked in the source",
    "D": "derived for mimoc",
}
"""What letters in parentheses at the end of a source say about how certain it is."""


@dataclass(frozen=True, slots=True)
class Explanation:
    """A number, the rule that gives it, and the numbers that the rule depends on."""

    key: str
    lines: tuple[str, ...]  # Value and unit, then the rule, its data, and the XML attribute that it is written to.
    sources: tuple["Explanation", ...]


def contents(bundle: Bundle | WorldBundle) -> dict[str, tuple[str, ...]]:
    """Return the sorted names of all numbers that can be explained, by object, such as `body.left_foot`."""
    groups = defaultdict[str, list[str]](list)
    for key in sorted(entries_of(bundle)):
        thing, _, name = key.rpartition(".")
        groups[thing].append(name)
    return {thing: tuple(names) for thing, names in sorted(groups.items())}


def find(bundle: Bundle | WorldBundle, text: str) -> dict[str, str]:
    """Return the values of all numbers whose key equals or contains a text, sorted by key.

    Args:
        bundle: The bundle.
        text: A key, part of a key (in any case, with `_` or blanks), or a pattern with `*` and `?`.

    Raises:
        MimocError: If there is no such number; the message suggests similar ones.
    """
    entries = entries_of(bundle)
    part = "_".join(text.lower().split())
    if text in entries:
        return {text: value_text(entries[text])}
    pattern = part if set(part) & set("*?") else f"*{part.replace('[', '[[]')}*"
    values = {key: value_text(entries[key]) for key in sorted(entries) if fnmatchcase(key.lower(), pattern)}
    if not values or not part:
        raise MimocError(f"no number of this bundle has '{text}' in its name; {_advice(part, entries)}")
    return values


def explain(bundle: Bundle | WorldBundle, key: str) -> Explanation:
    """Return the provenance of a number, back to its original sources.

    Raises:
        MimocError: If the bundle has no such number; the message suggests similar ones.
    """
    entries = entries_of(bundle)
    if key not in entries:
        raise MimocError(f"'{key}' is not a number of this bundle; {_advice(key, entries)}")
    return _explain(key, entries)


def legend(explanation: Explanation) -> str:
    """Return what the letters mean that say how certain the sources of a number are; empty if there are none."""
    used = MARK.findall("\n".join(_texts(explanation)))
    return "; ".join(f"{letter}: {meaning}" for letter, meaning in CERTAINTIES.items() if letter in used)


MARK = re.compile(r"\b([SMD])\)")


def _texts(explanation: Explanation) -> Iterator[str]:
    yield from explanation.lines
    for source in explanation.sources:
        yield from _texts(source)


def entries_of(bundle: Bundle | WorldBundle) -> Entries:
    """Return the provenance of all numbers; the bundles of a cohort leave it out, and it is worked out again.

    Raises:
        BundleError: If that is not possible, because this version of mimoc builds another infant from its spec.
    """
    if PROVENANCE in bundle.files:
        return read_entries(bundle.files[PROVENANCE])
    if SPEC_FILE not in bundle.files or isinstance(bundle, WorldBundle):
        raise BundleError(f"{bundle.path}: has neither {PROVENANCE} nor {SPEC_FILE}; build it again with 'mimoc build'")
    spec = read_spec(parse(bundle.files[SPEC_FILE], SPEC_FILE))
    again = builder(spec, skin=bundle.manifest.has_skin)(bundle.manifest.seed, check=False)
    if any(again.files[name] != bundle.files.get(name) for name in ("infant.xml", "scene.xml")):
        message = f"{bundle.path}: has no {PROVENANCE}, and this version of mimoc builds another infant from its spec"
        raise BundleError(f"{message}; build it again with 'mimoc build'")
    return read_entries(again.files[PROVENANCE])


def _explain(key: str, entries: Entries) -> Explanation:
    sources = entries[key].get("from", ())
    if len(sources) > MAX_FOLLOWED:
        values = tuple(Explanation(source, (value_text(entries[source]),), ()) for source in sources)
        return Explanation(key, _lines(entries[key]), values)
    return Explanation(key, _lines(entries[key]), tuple(_explain(source, entries) for source in sources))


def _lines(entry: Mapping[str, Any]) -> tuple[str, ...]:
    lines = [value_text(entry), entry["rule"]]
    if "fit" in entry:
        lines.append("fit: " + ", ".join(f"{name} = {_text(number)}" for name, number in entry["fit"].items()))
    lines += [f"{p['age_months']:g} months: {p['value_cm']:.4g} cm  ({p['origin']})" for p in entry.get("points", ())]
    if "xml" in entry:
        lines.append(f"written to {entry['xml']}")
    return tuple(lines)


def value_text(entry: Mapping[str, Any]) -> str:
    """Return the value of a number with its unit."""
    return f"{_text(entry['value'])} {entry.get('unit', '')}".rstrip()


def _text(value: Any) -> str:
    if isinstance(value, list):
        return " ".join(map(_text, value)) or "none"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _advice(text: str, entries: Entries) -> str:
    """Return advice with numbers, or parts of their names, that may have been meant."""
    parts = {part for key in entries for part in (key, *key.split("."), *key.replace(":", ".").split("."))}
    near = get_close_matches(text, sorted(parts), n=3, cutoff=0.6)
    if near:
        return f"did you mean {' or '.join(map(repr, near))}?"
    return "without one, `mimoc explain` lists them all"

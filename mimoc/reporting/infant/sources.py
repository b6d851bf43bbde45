"""Where the numbers on a page come from: the part of a bundle's provenance that the page refers to."""

import json
import re
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from mimoc.base.errors import MimocError
from mimoc.bundle.io import LOCK, Bundle, digests
from mimoc.compiler.explain import entries_of, value_text
from mimoc.compiler.provenance import SPEC_FILE
from mimoc.reporting import words
from mimoc.reporting.page import Block, Cell, Code, Details, Link, Section, TextBlock, number, table

GROUPS = {
    "who": "Percentiles",
    "child": "Size",
    "measurements": "Measurements",
    "body": "Masses and places of body parts",
    "geom": "Solids of the body",
    "joint": "Joints",
    "actuator": "Actuators",
    "delays": "Delays",
    "noise": "Noise",
    "spec": "The spec",
}
"""Heading of each kind of numbers; those of others follow, by their names."""
SIDE = re.compile(r"(left|right)_")
TITLE = "Where the numbers come from"
ABOUT = (
    "Every number that this page links to, and what that depends on, back to a row of a table or a line of the spec. "
    "mimoc explain does the same for all other numbers of the bundle."
)


class Sources:
    """The numbers of a bundle, and which of them a page refers to."""

    def __init__(self, bundle: Bundle) -> None:
        """Read the provenance of a bundle; without one that can be had, nothing is linked and a sentence says why."""
        self._named: dict[str, None] = {}
        self._reason = ""
        try:
            self._entries: Mapping[str, Mapping[str, Any]] = entries_of(bundle)
        except MimocError as error:
            self._entries, self._reason = {}, str(error)

    def links(self, *keys: str) -> tuple[Link, ...]:
        """Return the references to the origin of a number, none if it is not known."""
        known = [key for key in keys if key in self._entries]
        self._named |= dict.fromkeys(known)
        return tuple(Link(_fragment(key), "source") for key in known[:1])

    def section(self) -> Section:
        """Return the section on the origin of all numbers that were referred to so far."""
        if self._reason:
            return Section("sources", TITLE, (TextBlock(f"Not known here: {self._reason}.", "note"),))
        groups: dict[str, list[str]] = {}
        for key in sorted(self._followed()):
            groups.setdefault(key.split(".")[0], []).append(key)
        order = [name for name in GROUPS if name in groups] + [name for name in groups if name not in GROUPS]
        blocks = [self._group(GROUPS.get(name, words.sentence(name)), groups[name]) for name in order]
        return Section("sources", TITLE, (TextBlock(ABOUT), *blocks))

    def _followed(self) -> set[str]:
        """Return the numbers that were referred to, and all that they depend on."""
        reached, waiting = set[str](), list(self._named)
        while waiting:
            key = waiting.pop()
            if key in self._entries and key not in reached:
                reached.add(key)
                waiting += self._entries[key].get("from", ())
        return reached

    def _group(self, title: str, keys: list[str]) -> Block:
        rows = [self._row(twins) for twins in self._twins(keys)]
        headings = ("number", "value", "where it comes from")
        return Details(f"{title} ({len(rows)})", (table(headings, rows),))

    def _twins(self, keys: Iterable[str]) -> Iterator[tuple[str, ...]]:
        """Yield numbers, those of left and right together where they are the same."""
        twins: dict[str, list[str]] = {}
        for key in keys:
            same = json.dumps([SIDE.sub("{side}_", key), self._entries[key]], sort_keys=True)
            twins.setdefault(SIDE.sub("{side}_", same), []).append(key)
        yield from map(tuple, twins.values())

    def _row(self, twins: tuple[str, ...]) -> tuple[Cell, ...]:
        key, entry = twins[-1], self._entries[twins[-1]]
        name = key if len(twins) == 1 else f"{key} (and left)"
        sources = [source for source in entry.get("from", ()) if source in self._entries]
        fit = ", ".join(f"{letter} = {value:.4g}" for letter, value in entry.get("fit", {}).items())
        rule = entry["rule"] + (f"; a log(age + b) + c + d age with {fit}" if fit else "")
        links = tuple(Link(_fragment(source), source) for source in sources)
        anchors = tuple(map(_fragment, twins))
        return Cell(name, "code", anchors=anchors), number(value_text(entry)), Cell(rule, links=links)


def _fragment(key: str) -> str:
    """Return the fragment of a number on the page."""
    return "n-" + re.sub(r"\s+", "-", key)


def origin(bundle: Bundle) -> Section:
    """Return the section on what an infant was made from."""
    versions = words.listed([f"{name} {version}" for name, version in sorted(bundle.versions.items())])
    digest = digests({LOCK: bundle.files[LOCK]})[LOCK]
    rows = [(Cell("Built with"), Cell(versions)), (Cell("Digest of its lock"), Cell(digest, "code"))]
    rows += [(Cell("Note"), Cell(note)) for note in bundle.manifest.notes]
    spec = (
        Code(bundle.files[SPEC_FILE].decode(errors="replace"))
        if SPEC_FILE in bundle.files
        else TextBlock("It has no spec.", "note")
    )
    blocks = (table(("", ""), rows), Details("The spec, as it was written", (spec,)))
    return Section("spec", "What it was made from", blocks)

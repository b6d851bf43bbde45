"""Where the numbers on a page come from: the part of a bundle's provenance that the page refers to."""

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from mimoc.base.errors import MimocError
from mimoc.bundle.io import LOCK, Bundle, digests, versions_in
from mimoc.bundle.world import WorldBundle
from mimoc.compiler.explain import entries_of, value_text
from mimoc.compiler.provenance import SPEC_FILE
from mimoc.studies.reporting import words
from mimoc.studies.reporting.page import Block, Cell, Code, Details, Link, Section, TextBlock, number, table

GROUPS = {  # Heading of each kind of numbers; those of others follow, by their names.
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
SIDE = re.compile(r"(left|right)_")
TITLE = "Where the numbers come from"
ABOUT = (
    "Every number that this page links to, and what that depends on, back to a row of a table or a line of the spec. "
    "mimoc explain does the same for all other numbers of the bundle."
)


class Sources:
    """The numbers of a bundle, and which of them a page refers to."""

    def __init__(self, bundle: Bundle, prefix: str = "") -> None:
        """Read the provenance of a bundle; without one that can be had, nothing is linked and a sentence says why.

        Places on the page begin with *prefix*, so that it can have the numbers of several infants.
        """
        self._prefix = prefix
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
        return tuple(Link(self._fragment(key), "source") for key in known[:1])

    def section(self) -> Section:
        """Return the section on the origin of all numbers that were referred to so far."""
        if self._reason:
            return Section("sources", TITLE, (TextBlock(f"Not known here: {self._reason}.", "note"),))
        groups: dict[str, list[str]] = {}
        for key in sorted(self._followed()):
            groups.setdefault(key.split(".")[0], []).append(key)
        blocks: list[Block] = [TextBlock(ABOUT)]
        for name in dict.fromkeys((*(name for name in GROUPS if name in groups), *groups)):
            rows = [self._row(twins) for twins in self._twins(groups[name])]
            title = f"{GROUPS.get(name, words.sentence(name))} ({len(rows)})"
            blocks.append(Details(title, (table(("number", "value", "where it comes from"), rows),)))
        return Section("sources", TITLE, tuple(blocks))

    def _followed(self) -> set[str]:
        reached, waiting = set[str](), list(self._named)
        while waiting:
            key = waiting.pop()
            if key in self._entries and key not in reached:
                reached.add(key)
                waiting += self._entries[key].get("from", ())
        return reached

    def _twins(self, keys: Iterable[str]) -> Iterable[list[str]]:
        """Return numbers, those of left and right together where they are the same."""
        twins: dict[str, list[str]] = {}
        for key in keys:
            same = json.dumps([key, self._entries[key]], sort_keys=True)
            twins.setdefault(SIDE.sub("{side}_", same), []).append(key)
        return twins.values()

    def _row(self, twins: Sequence[str]) -> tuple[Cell, ...]:
        key, entry = twins[-1], self._entries[twins[-1]]
        name = key if len(twins) == 1 else f"{key} (and left)"
        fit = ", ".join(f"{letter} = {value:.4g}" for letter, value in entry.get("fit", {}).items())
        rule = entry["rule"] + (f"; a log(age + b) + c + d age with {fit}" if fit else "")
        links = tuple(
            Link(self._fragment(source), source) for source in entry.get("from", ()) if source in self._entries
        )
        anchors = tuple(map(self._fragment, twins))
        return Cell(name, "code", anchors=anchors), number(value_text(entry)), Cell(rule, links=links)

    def _fragment(self, key: str) -> str:
        return f"{self._prefix}n-" + re.sub(r"\s+", "-", key)


def origin(bundle: Bundle | WorldBundle) -> Section:
    """Return the section on what an infant or a world was made from."""
    versions = words.listed([f"{name} {version}" for name, version in sorted(versions_in(bundle.files).items())])
    digest = digests({LOCK: bundle.files[LOCK]})[LOCK]
    rows = [(Cell("Built with"), Cell(versions)), (Cell("Digest of its lock"), Cell(digest, "code"))]
    rows += [(Cell("Note"), Cell(note)) for note in bundle.manifest.notes]
    spec: Block = TextBlock("It has no spec.", "note")
    if SPEC_FILE in bundle.files:
        spec = Code(bundle.files[SPEC_FILE].decode(errors="replace"))
    blocks = (table(("", ""), rows), Details("The spec, as it was written", (spec,)))
    return Section("spec", "What it was made from", blocks)

"""Where a number of a bundle comes from, told from the XML attribute back to the table row."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from mimoc.bundle import Bundle
from mimoc.errors import UnknownNameError


@dataclass(frozen=True, slots=True)
class Explanation:
    """A number, the rule it follows, and the numbers that the rule takes."""

    key: str
    lines: tuple[str, ...]
    """Value and unit; then the rule, the data behind it and the XML attribute it ends up in."""
    sources: tuple["Explanation", ...]


def explain(bundle: Bundle, key: str) -> Explanation:
    """Return where a number comes from, all the way back.

    Raises:
        UnknownNameError: If the bundle has no such number; it lists the near ones.
    """
    entries = json.loads(bundle.files["provenance.json"])
    if key not in entries:
        raise UnknownNameError("number of this bundle", key, _candidates(key, entries))
    return _explain(key, entries)


def _explain(key: str, entries: Mapping[str, Mapping[str, Any]]) -> Explanation:
    entry = entries[key]
    return Explanation(key, _lines(entry), tuple(_explain(source, entries) for source in entry.get("from", ())))


def _lines(entry: Mapping[str, Any]) -> tuple[str, ...]:
    lines = [f"{_text(entry['value'])} {entry.get('unit', '')}".rstrip(), entry["rule"]]
    if "fit" in entry:
        lines.append("fit: " + ", ".join(f"{name} = {_text(number)}" for name, number in entry["fit"].items()))
    lines += [f"{p['age_months']:g} months: {p['value_cm']:.4g} cm  ({p['origin']})" for p in entry.get("points", ())]
    if "xml" in entry:
        lines.append(f"written to {entry['xml']}")
    return tuple(lines)


def _text(value: Any) -> str:
    if isinstance(value, list):
        return " ".join(map(_text, value)) or "none"
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _candidates(key: str, entries: Mapping[str, Any]) -> list[str]:
    """Return the keys that are worth naming: those of the same kind, or else one example of each kind."""
    kind = key.split(".")[0]
    same_kind = [known for known in entries if known.split(".")[0] == kind]
    return same_kind or ["body.head.mass", "actuator.act:left_elbow.gear", "measurements.head_circumference_cm"]

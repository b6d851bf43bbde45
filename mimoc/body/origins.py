"""Where a number comes from: how it was computed, from which publication, and the keys of the numbers that it follows.

In the texts, S means read in the source, M known from memory, D derived for mimoc.
"""

from dataclasses import dataclass, replace
from typing import Any

Entry = dict[str, Any]
"""`value`, `unit`, `rule`, and if they apply `from` (keys of other entries), `fit`, `points` and `xml`."""

REFERENCE = "MIMo's reference body, 18 months"
CONSTANT = f"{REFERENCE}; the same at every age"
LENGTH_KEY, AGE_KEY, LAW_KEY = "measurements.crown_sole_length_cm", "spec.age_months", "spec.development"
LAW = "the law `maturing`"


@dataclass(frozen=True, slots=True)
class Origin:
    """Origin of a number, for provenance."""

    rule: str  # How it is computed, and the publication.
    sources: tuple[str, ...] = ()  # Keys (of `mimoc explain`) of the numbers that it is computed from.
    unit: str = ""  # Its unit; empty if it has none, or consists of numbers with different units.

    def times(self, text: str, *sources: str) -> "Origin":
        """Return the origin of the number that is multiplied by another, which *text* describes."""
        return replace(self, rule=self.rule + text, sources=(*self.sources, *sources))

    def entry(self, value: Any, xml: str = "", unit: str = "") -> Entry:
        """Return a number's entry in the provenance; *xml* is where it stands in the MJCF."""
        optional = {"unit": unit or self.unit, "from": list(self.sources), "xml": xml}
        return {"value": value, "rule": self.rule, **{key: part for key, part in optional.items() if part}}

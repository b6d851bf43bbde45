"""When real infants reach motor milestones."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

Certainty = Literal["read", "from memory"]
"""Whether the figures were read in the source or its abstract, or are known from memory and not yet checked."""


@dataclass(frozen=True, slots=True)
class AgeRange:
    """Ages at which infants reach a milestone, in months."""

    youngest_months: float
    oldest_months: float
    median_months: float
    span: str
    """What youngest and oldest are, such as percentiles."""
    source: str
    certainty: Certainty

    def contains(self, age_months: float) -> bool:
        """Return whether an age lies in the window, ends included."""
        return self.youngest_months <= age_months <= self.oldest_months


WHO = "WHO Multicentre Growth Reference Study Group 2006, Acta Paediatr Suppl 450: 86-95"
PERCENTILES = "1st to 99th percentile"

WINDOWS: Mapping[str, AgeRange] = {
    "prone_head": AgeRange(1.5, 3.0, 2.0, "usual ages", "Denver II (Frankenburg et al. 1992)", "from memory"),
    "arm_out": AgeRange(3.5, 5.0, 4.0, "usual ages of first reaches", "Bhat & Galloway 2007; von Hofsten 1991", "read"),
    "no_head_lag": AgeRange(
        3.0,
        6.0,
        4.5,
        "from partial lag at 3 to 90 % without lag",
        "Gerber, Wilks & Erdie-Lalena 2010 (3 and 4-5 months: read); Denver II (90 % by 6)",
        "from memory",
    ),
    "sit": AgeRange(3.8, 9.2, 5.9, PERCENTILES, f"{WHO}: sitting without support", "read"),
    "hands_and_knees": AgeRange(
        5.2,
        13.5,
        6.5,
        f"{PERCENTILES} of crawling; median of keeping still",
        f"{WHO}: hands-and-knees crawling (read); Alberta Infant Motor Scale (Piper & Darrah 1994): still at 6-7",
        "from memory",
    ),
    "stand": AgeRange(6.9, 16.9, 10.8, PERCENTILES, f"{WHO}: standing alone", "read"),
    "half_squat": AgeRange(
        3.0,
        7.0,
        4.5,
        "usual ages at which legs carry some weight",
        "Denver test (Frankenburg & Dodds 1967)",
        "from memory",
    ),
    "supine_head": AgeRange(4.0, 9.0, 6.0, "usual ages", "van Iersel & Hadders-Algra 2021", "read"),
    "pull_to_stand": AgeRange(4.8, 11.4, 7.4, PERCENTILES, f"{WHO}: standing with assistance", "read"),
    "roll_over": AgeRange(3.0, 6.0, 5.0, "usual ages", "Gerber, Wilks & Erdie-Lalena 2010", "read"),
}
"""By name of the trial. WHO's medians are from memory, the other figures of WHO were read."""

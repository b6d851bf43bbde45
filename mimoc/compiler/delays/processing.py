"""How long an infant takes to decide: what its responses take in all, less the conduction in and out."""

import math
from collections.abc import Iterator, Mapping

import numpy as np

from mimoc.body.origins import Entry, Origin
from mimoc.schema.delays import DelaysEntry, ProcessingEntry
from mimoc.schema.infant import InfantSpec

SIGHT = "vision"
SACCADE_MS: Mapping[float, float] = dict(
    zip((0, 1, 2, 3, 4, 6, 8.5, 12, 24), (800, 600, 500, 450, 420, 350, 300, 250, 230), strict=True)
)
"""From a new target to the beginning of a saccade, by months. Derived (D): below 500 ms on many trials at 1 and 2
months (R), 242 to 250 at 9 to 15 (S)."""
REACH_MS: Mapping[float, float] = {4: 1500, 6: 600, 8.5: 500, 12: 450, 24: 400}
"""From a seen object to the first movement of the hand, by months (from memory, M); earlier as at 4."""
ADULT_SACCADE_MS, ADULT_REACH_MS = 180.0, 250.0
VARIATION: Mapping[float, float] = {4: 0.35, 12: 0.2}
"""Standard deviation of the response of one infant, as a share of its mean, by months (from memory, M)."""
LEAST_MS = 60.0
"""No decision is quicker on average."""
RESPONSES = {"look": (SACCADE_MS, ADULT_SACCADE_MS), "reach": (REACH_MS, ADULT_REACH_MS)}
RULES = {
    "look": "time to a saccade (D: < 500 ms at 1 and 2 months, 242 to 250 at 9 to 15)",
    "reach": "time to the first movement of the hand (from memory, M)",
}
VARIES = "an infant's responses vary by .35 of their mean until 4 months, by .2 from 12 (from memory, M)"


def processing(spec: InfantSpec, delays: DelaysEntry) -> ProcessingEntry | None:
    """Return the decisions of an infant with some delays, or None if it decides at once.

    A response of mean t and variation v, of which conduction takes c, has a decision of mean d = max(t - c, 60 ms) and
    of variation v t / d, so that the whole response varies by v.
    """
    if spec.delays.processing in (None, "off"):
        return None
    is_adult, months = spec.delays.processing == "adult", spec.corrected_age_months
    conduction_ms, numbers = getattr(delays, SIGHT).ms + delays.motor.ms, dict[str, float]()
    for name, (by_age, adult_ms) in RESPONSES.items():
        mean_ms = adult_ms if is_adult else _at(by_age, months)
        decision_ms = max(LEAST_MS, mean_ms - conduction_ms)
        variation = _at(VARIATION, math.inf if is_adult else months)
        numbers |= {f"{name}_ms": decision_ms, f"{name}_variation": variation * mean_ms / decision_ms}
    return ProcessingEntry(**numbers)


def _at(by_age: Mapping[float, float], months: float) -> float:
    return float(np.interp(months, list(by_age), list(by_age.values())))


def trace_processing(spec: InfantSpec, delays: DelaysEntry) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each number of the decisions in the manifest."""
    if delays.processing is None:
        return
    sources = ["spec.delays.processing", f"delays.{SIGHT}.ms", "delays.motor.ms"]
    sources += ["spec.age_months"] if spec.delays.processing == "age" else []
    for name, rule in RULES.items():
        for key, text, unit in (
            (f"{name}_ms", f"{rule}, less conduction in and out, {LEAST_MS:g} ms or more", "ms"),
            (f"{name}_variation", f"{VARIES}; such that all of the response varies so", "1"),
        ):
            yield f"delays.processing.{key}", Origin(text, tuple(sources), unit).entry(getattr(delays.processing, key))

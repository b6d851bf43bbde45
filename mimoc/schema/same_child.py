"""What a spec says of its child in cm and kg, at another age of the same child."""

from typing import Any

from mimoc.rounding import rounded
from mimoc.schema.body import INDICATORS, BodySpec, IndividualSpec
from mimoc.schema.names import unsided
from mimoc.schema.sizes import pairs

OLDEST_MONTHS = 24
"""Last age of the growth tables."""


def at_another_age(body: BodySpec, before_months: float, after_months: Any) -> dict[str, Any]:
    """Return what changes in a body when its child has another age: sections with new values by key, None to remove.

    An individual keeps its percentiles: a measured length, weight or head becomes what a child with the same z-score by
    WHO's standards has then, z(after) = z(before). A single measurement keeps its ratio to the average child's.
    Percentiles and factors stay as they are. What is said twice is said once from then on: the individual's measure
    counts, not its percentile, nor the measurement of the same size.

    Args:
        body: The body.
        before_months: The age at which it was measured.
        after_months: The other age, as a user gives it; if it is none, nothing changes, and validation says why.
    """
    if not all(_is_age(months) for months in (before_months, after_months)):
        return {}
    if rounded(float(after_months)) == rounded(before_months):  # Ages in manifests are rounded.
        return {}
    changes: dict[str, Any] = {}
    if body.individual and (grown := grown_individual(body.individual, before_months, after_months)):
        changes["individual"] = grown
    if body.measurements:
        changes["measurements"] = _grown_measurements(body, before_months, after_months)
    return changes


def grown_individual(individual: IndividualSpec, before_months: float, after_months: float) -> dict[str, float | None]:
    """Return what changes of an individual at another age: its measures, and None for percentiles that repeat them."""
    from mimoc.fits import load_tables  # Bundles are opened without tables of growth.

    grown: dict[str, float | None] = {}
    for key, percentile in INDICATORS.items():
        value, standard, reference = getattr(individual, key), load_tables().who[key], individual.sex or "mean"
        if value is not None:
            z = standard.z_score(value, before_months, reference)
            grown[key] = rounded(standard.value(z, after_months, reference))
            grown |= {percentile: None} if getattr(individual, percentile) is not None else {}
    return grown


def _grown_measurements(body: BodySpec, before_months: float, after_months: float) -> dict[str, float | None]:
    """Return measurements at another age; None for those that repeat what the individual says."""
    from mimoc.fits import measure

    before, after = measure(before_months), measure(after_months)
    grown: dict[str, float | None] = {}
    for key, value_cm in body.measurements.items():
        name = unsided(key)
        grown[key] = rounded(value_cm * after[name] / before[name])
    for earlier, later, _ in pairs(body, before_months):
        if earlier.path[1] == "individual" and later.path[1] == "measurements":
            grown[str(later.path[-1])] = None
    return grown


def _is_age(months: Any) -> bool:
    return isinstance(months, int | float) and not isinstance(months, bool) and 0 <= months <= OLDEST_MONTHS

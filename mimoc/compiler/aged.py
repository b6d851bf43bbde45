"""The spec of the same child at another age: whatever a spec says in cm or kg grows with the child."""

from collections.abc import Iterator
from typing import Any

from mimoc.fits import load_tables, measure
from mimoc.rounding import rounded
from mimoc.schema.body import IndividualSpec
from mimoc.schema.infant import InfantSpec
from mimoc.schema.names import SIDES

MEASURED = ("length_cm", "weight_kg", "head_circumference_cm")
"""What can be measured of an individual child, by WHO's indicators."""


def aged(spec: InfantSpec, age_months: float) -> InfantSpec:
    """Return the spec of a spec's child at another age.

    An individual keeps its percentiles: a measured length, weight or head becomes what a child with the same z-score by
    WHO's standards has then. A single measurement keeps its ratio to the average child's. Ratios and delays, acuities
    and the like that a spec gives by number stay as they are.

    Args:
        spec: The child.
        age_months: The age, as it stands in manifests.

    Raises:
        SpecError: If no spec can say so; the error lists all problems.
    """
    if age_months == rounded(spec.age_months):
        return spec
    body = dict(_grown_body(spec, age_months))
    return spec.with_(age_months=age_months, **({"body": body} if body else {}))


def quickly_aged(spec: InfantSpec, age_months: float) -> InfantSpec:
    """Return a spec with the same values as `aged`; where one number changes, it is not written as a file is."""
    if spec.body.measurements or spec.body.individual:
        return aged(spec, age_months)
    return spec if age_months == rounded(spec.age_months) else spec.model_copy(update={"age_months": age_months})


def grown_individual(individual: IndividualSpec, before_months: float, after_months: float) -> dict[str, float]:
    """Return the measures of an individual at another age, by key; its percentiles stay the same."""
    who, found = load_tables().who, {}
    for key in MEASURED:
        value = getattr(individual, key)
        if value is not None:
            z = who[key].z_score(value, before_months, individual.sex or "mean")
            found[key] = who[key].value(z, after_months, individual.sex or "mean")
    return found


def _grown_body(spec: InfantSpec, age_months: float) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the keys of the body that say something in cm or kg, with what they say at another age."""
    if spec.body.measurements:
        before, after = measure(spec.age_months), measure(age_months)
        names = {key: _of_both_sides(key.removesuffix("_cm")) for key in spec.body.measurements}
        yield (
            "measurements",
            {key: value * after[names[key]] / before[names[key]] for key, value in spec.body.measurements.items()},
        )
    if spec.body.individual and (grown := grown_individual(spec.body.individual, spec.age_months, age_months)):
        yield "individual", grown


def _of_both_sides(measurement: str) -> str:
    """Return the name of a measurement without its side, if it has one."""
    for side in SIDES:
        measurement = measurement.removeprefix(f"{side}_")
    return measurement

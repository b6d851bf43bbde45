"""One child instead of the average one: the few scale factors that give it its length, weight and head."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from statistics import NormalDist

from mimoc.body.tree import BodyTree
from mimoc.errors import IndividualError
from mimoc.fits import Measurements, load_tables
from mimoc.fits.who import Sex
from mimoc.geometry.solvers import root
from mimoc.schema.body import HEADS_CM, LENGTHS_CM, WEIGHTS_KG, IndividualSpec
from mimoc.units import cm_to_m, m_to_cm

Grow = Callable[[Measurements], BodyTree]
Bounds = tuple[float, float]

WHY = "for this child"
SIZES: Bounds = (0.75, 1.25)
"""Least and largest size against the average child of the same age; WHO's percentiles 1 to 99 reach .81 to 1.17."""
BUILDS: Bounds = (0.65, 1.45)
"""Least and largest girth against length, both relative to the average child's; WHO's combine to .71 to 1.35."""
HEADS: Bounds = (0.75, 1.4)
"""Least and largest head against length, both relative to the average child's; WHO's combine to .79 to 1.33."""
HEAD = ("head_circumference", "head_breadth", "head_length")
_PRECISION = 1e-12
"""Of a factor, so that no digit that files hold depends on the search."""


@dataclass(frozen=True, slots=True)
class Targets:
    """What is wanted of one child; None where it is to follow from the rest."""

    length_m: float | None
    weight_kg: float | None
    head_m: float | None


def targets(individual: IndividualSpec, age_months: float) -> Targets:
    """Return what a child is to measure, percentiles looked up in WHO's tables for its sex and age."""

    def wanted(indicator: str, value: float | None, percentile: float | None) -> float | None:
        if percentile is None:
            return value
        z = NormalDist().inv_cdf(percentile / 100)
        sex: Sex = individual.sex or "female"  # The schema asks for a sex where there is a percentile.
        return load_tables().who[indicator].value(z, age_months, sex)

    length_cm = wanted("length_cm", individual.length_cm, individual.length_percentile)
    head_cm = wanted("head_circumference_cm", individual.head_circumference_cm, individual.head_percentile)
    return Targets(
        length_m=None if length_cm is None else cm_to_m(length_cm),
        weight_kg=wanted("weight_kg", individual.weight_kg, individual.weight_percentile),
        head_m=None if head_cm is None else cm_to_m(head_cm),
    )


def individualise(measurements: Measurements, individual: IndividualSpec, grow: Grow) -> Measurements:
    """Return the measurements of one child.

    Lengths, girths and head each have one factor, so that AnthroKids' proportions are kept. What is not
    given follows: length from weight, or else from the head; girths from weight, or else from length; the
    head from length.

    Args:
        measurements: Of the average child of this age.
        individual: What is known of the child.
        grow: From measurements to the body whose weight counts.

    Raises:
        IndividualError: If no child measures this; it says what is possible.
    """
    wanted = targets(individual, measurements.age_months)
    keys = tuple(f"spec.body.individual.{key}" for key, value in individual if value is not None)
    length = _factor(wanted.length_m, measurements["crown_sole_length"], SIZES, LENGTHS_CM, "this age is not {} long")
    of_size = f"{m_to_cm(wanted.length_m):.1f} cm" if wanted.length_m else "this age"
    heads = _times(HEADS, length or 1.0)
    head = _factor(wanted.head_m, measurements["head_circumference"], heads, HEADS_CM, of_size + " has no head of {}")

    def child(length: float, girth: float) -> Measurements:
        return measurements.scaled(_factors(measurements, length, girth, head or length), WHY, keys)

    def thick(girth: float) -> Measurements:
        return child(length or girth, girth)

    if wanted.weight_kg is None:
        return thick(length or head or 1.0)
    bounds = SIZES if length is None else _times(BUILDS, length)
    return thick(_solve(lambda girth: grow(thick(girth)).mass_kg, wanted.weight_kg, bounds, of_size))


def _factors(measurements: Measurements, length: float, girth: float, head: float) -> dict[str, float]:
    """Return the factor of each measurement."""
    return {name: head if name in HEAD else length if name.endswith("_length") else girth for name in measurements}


def _factor(wanted_m: float | None, average_m: float, bounds: Bounds, limits_cm: Bounds, child: str) -> float | None:
    """Return what is wanted over the average.

    Raises:
        IndividualError: If that is not within *bounds*; it gives the lengths that are.
    """
    if wanted_m is None:
        return None
    least, largest = bounds
    if not least <= wanted_m / average_m <= largest:
        possible = _range(_times(bounds, m_to_cm(average_m)), limits_cm, "cm")
        raise IndividualError(f"a child of {child.format(f'{m_to_cm(wanted_m):.1f} cm')}; {possible}")
    return wanted_m / average_m


def _solve(weigh: Callable[[float], float], wanted_kg: float, bounds: Bounds, child: str) -> float:
    """Return the factor at which a child weighs what is wanted.

    Raises:
        IndividualError: If none within *bounds* does; it gives the weights that are possible.
    """
    low, high = bounds
    lightest_kg, heaviest_kg = weigh(low), weigh(high)
    if not lightest_kg <= wanted_kg <= heaviest_kg:
        possible = _range((lightest_kg, heaviest_kg), WEIGHTS_KG, "kg")
        raise IndividualError(f"a child of {child} does not weigh {wanted_kg:.1f} kg; {possible}")
    return root(lambda factor: weigh(factor) - wanted_kg, low, high, _PRECISION)


def _range(bounds: Bounds, limits: Bounds, unit: str) -> str:
    """Return advice to stay within bounds, rounded inwards, and within what a spec can say."""
    least, largest = max(bounds[0], limits[0]), min(bounds[1], limits[1])
    return f"give {math.ceil(10 * least) / 10:.1f} to {math.floor(10 * largest) / 10:.1f} {unit}"


def _times(bounds: Bounds, factor: float) -> Bounds:
    return bounds[0] * factor, bounds[1] * factor

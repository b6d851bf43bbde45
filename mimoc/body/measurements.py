"""The measurements of a spec's child: the average child's, scaled to an individual, and replaced where a spec says."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from statistics import NormalDist

from mimoc.base.errors import GeometryError, IndividualError
from mimoc.base.geometry.solvers import root
from mimoc.base.units import cm_to_m, m_to_cm
from mimoc.fits import Measured, Measurements, load_tables
from mimoc.fits.standards import PRETERM_Z_AT_TERM, Reference, Sex, preterm_share
from mimoc.schema.body import HEADS_CM, INDICATORS, LENGTHS_CM, WEIGHTS_KG, IndividualSpec
from mimoc.schema.infant import InfantSpec

Weigh = Callable[[Measurements], float]  # Returns the mass of a child with some measurements, in [kg].
Height = Callable[[Measurements], float]
"""Returns the standing height of a child with some measurements: a sum of multiples of these and a constant, in [m]."""
Bounds = tuple[float, float]

SIZES: Bounds = (0.75, 1.25)
"""Range of size relative to the average child of the same age; WHO's percentiles 1 to 99 span .81 to 1.17."""
BUILDS: Bounds = (0.65, 1.45)
"""Range of girth over length, both relative to the average child's; WHO's percentiles combine to .71 to 1.35."""
HEADS: Bounds = (0.75, 1.4)
"""Range of head over length, both relative to the average child's; WHO's percentiles combine to .79 to 1.33."""
SIZING = {"sex", *(key for pair in INDICATORS.items() for key in pair)}
"""Keys of an individual that its sizes follow from."""
HEAD = ("head_circumference", "head_breadth", "head_length")
EDGE = 1e-3  # Precision of the limit of possible factors.
_PRECISION = 1e-12  # Precision of a factor, such that no digit in a file depends on the root finding.


@dataclass(frozen=True, slots=True)
class Targets:
    """Requested measures of a child; None for those that follow from the others."""

    length_m: float | None
    weight_kg: float | None
    head_m: float | None
    keys: tuple[str, ...] = ()  # Keys of the spec that ask for them.
    why: str = "for this child"  # What the origin of each measurement says of its factor.


def targets(individual: IndividualSpec, age_months: float) -> Targets:
    """Return the requested measures of a child, with percentiles looked up in WHO's tables for its sex and age.

    Of a measure and its percentile, which the schema requires to agree, the measure counts.
    """

    def wanted(indicator: str, value: float | None, percentile: float | None) -> float | None:
        if value is not None or percentile is None:
            return value
        z = NormalDist().inv_cdf(percentile / 100)
        sex: Sex = individual.sex or "female"  # The schema requires a sex if a percentile is given.
        return load_tables().who[indicator].value(z, age_months, sex)

    length_cm = wanted("length_cm", individual.length_cm, individual.length_percentile)
    head_cm = wanted("head_circumference_cm", individual.head_circumference_cm, individual.head_percentile)
    return Targets(
        length_m=None if length_cm is None else cm_to_m(length_cm),
        weight_kg=wanted("weight_kg", individual.weight_kg, individual.weight_percentile),
        head_m=None if head_cm is None else cm_to_m(head_cm),
        keys=tuple(f"spec.body.individual.{key}" for key, value in individual if value is not None and key in SIZING),
    )


def asked_targets(spec: InfantSpec) -> Targets | None:
    """Return the measures that a spec asks for; None if it gives no size."""
    individual = spec.body.individual
    if individual and any(getattr(individual, key) is not None for key in SIZING - {"sex"}):
        return targets(individual, spec.corrected_age_months)
    return None


def birth_targets(spec: InfantSpec, average: Measurements, weigh: Weigh, height: Height) -> Targets | None:
    """Return the measures that children born as early usually have at its age; None of a child born at term.

    They differ from the average child's by a share of the standard deviations `PRETERM_Z_AT_TERM`:
    z = z(average) + share x z_at_term.
    """
    if not spec.months_early:
        return None
    individual, age_months = spec.body.individual, average.age_months
    share = preterm_share(spec.months_early, age_months)
    reference: Reference = (individual and individual.sex) or "mean"

    def smaller(indicator: str, usual: float) -> float:
        standard = load_tables().who[indicator]
        z = standard.z_score(usual, age_months, reference) + share * PRETERM_Z_AT_TERM[indicator]
        return standard.value(z, age_months, reference)

    return Targets(
        length_m=cm_to_m(smaller("length_cm", m_to_cm(height(average)))),
        weight_kg=smaller("weight_kg", weigh(average)),
        head_m=cm_to_m(smaller("head_circumference_cm", m_to_cm(average["head_circumference"]))),
        keys=spec.birth_keys,
        why="as children born as early usually have it (Johnson et al. 2011, S; how they catch up, D)",
    )


def measure_individual(spec: InfantSpec, average: Measurements, weigh: Weigh, height: Height) -> Measurements:
    """Return the measurements of a spec's child, which has those of the average child unless its spec says more.

    What is not given of a child born early follows from what is, by the proportions of children born as early.

    Raises:
        IndividualError: If no child matches the requested individual.
    """
    child = average
    for wanted in (birth_targets(spec, average, weigh, height), asked_targets(spec)):
        child = child if wanted is None else individualise(child, wanted, weigh, height)
    return replace_given(child, spec)


def replace_given(measurements: Measurements, spec: InfantSpec) -> Measurements:
    """Return the measurements, with those that the spec gives replacing the child's own."""
    given = {
        key.removesuffix("_cm"): Measured(
            cm_to_m(value_cm), "given by the spec", given_by=(f"spec.body.measurements.{key}",)
        )
        for key, value_cm in spec.body.measurements.items()
    }
    return measurements.replaced(given) if given else measurements


def individualise(measurements: Measurements, wanted: Targets, weigh: Weigh, height: Height) -> Measurements:
    """Return the measurements of a child that has some measures, from those of the average child of its age.

    Lengths, girths and head have one factor each, so that AnthroKids' proportions are kept. Measures that are not
    given follow from the others: length from weight, or else from the head; girths from weight, or else from length;
    the head from length.

    Raises:
        IndividualError: If no child matches; the message gives the possible range.
    """
    length = _factor(wanted.length_m, height(measurements), SIZES, LENGTHS_CM, "this age is not {} long")
    of_size = f"{m_to_cm(wanted.length_m):.1f} cm" if wanted.length_m else "this age"
    heads = _times(HEADS, length or 1.0)
    _factor(wanted.head_m, measurements["head_circumference"], heads, HEADS_CM, of_size + " has no head of {}")

    alone = replace(measurements, paper=None)

    def thick(girth: float | None) -> Measurements:
        """Return the measurements with this factor on girths; None is the factor on lengths."""
        paper = measurements.paper and _scaled(measurements.paper, wanted, girth, height)
        return replace(_scaled(alone, wanted, girth, height), paper=paper)

    if wanted.weight_kg is None:
        head = wanted.head_m and wanted.head_m / measurements["head_circumference"]
        return thick(None if length else head or 1.0)
    least, most = SIZES if length is None else _times(BUILDS, length)

    def is_possible(girth: float) -> bool:
        try:
            weigh(thick(girth))
        except GeometryError:
            return False
        return True

    bounds = _possible(least, length or 1.0, is_possible), _possible(most, length or 1.0, is_possible)
    return thick(_solve(lambda girth: weigh(thick(girth)), wanted.weight_kg, bounds, of_size))


def _scaled(average: Measurements, wanted: Targets, girth: float | None, height: Height) -> Measurements:
    """Return the measurements of a child of the requested length and head, with the given factor on its girths.

    The factor on lengths is what the head, and where the height also follows girths these, leave of the height.
    """

    def scaled(length: float) -> Measurements:
        across = length if girth is None else girth
        head = wanted.head_m / average["head_circumference"] if wanted.head_m else length
        factors = {name: head if name in HEAD else length if name.endswith("_length") else across for name in average}
        child = average.scaled(factors, wanted.why, wanted.keys)
        return replace(child, slenderness=average.slenderness * (length / across) if across else 1.0)

    length = girth or 1.0
    if wanted.length_m:
        without_m = height(scaled(0.0))
        length = (wanted.length_m - without_m) / (height(scaled(1.0)) - without_m)
    return scaled(length)


def _factor(wanted_m: float | None, average_m: float, bounds: Bounds, limits_cm: Bounds, child: str) -> float | None:
    """Return the ratio of the requested measure to the average, or an IndividualError with possible lengths."""
    if wanted_m is None:
        return None
    least, largest = bounds
    if not least <= wanted_m / average_m <= largest:
        possible = _range(_times(bounds, m_to_cm(average_m)), limits_cm, "cm")
        raise IndividualError(f"a child of {child.format(f'{m_to_cm(wanted_m):.1f} cm')}; {possible}")
    return wanted_m / average_m


def _possible(factor: float, usual: float, is_possible: Callable[[float], bool]) -> float:
    """Return the factor, or the one nearest to it with which there is a body, as there is with the *usual* one."""
    if is_possible(factor) or not is_possible(usual):
        return factor

    def sign(share: float) -> float:
        return -1.0 if is_possible(usual + share * (factor - usual)) else 1.0

    return usual + (root(sign, 0.0, 1.0, EDGE, "bisect") - EDGE) * (factor - usual)


def _solve(weigh: Callable[[float], float], wanted_kg: float, bounds: Bounds, child: str) -> float:
    """Return the factor at which a child has the weight, or raise an IndividualError with possible weights."""
    low, high = bounds
    lightest_kg, heaviest_kg = weigh(low), weigh(high)
    if not lightest_kg <= wanted_kg <= heaviest_kg:
        possible = _range((lightest_kg, heaviest_kg), WEIGHTS_KG, "kg")
        raise IndividualError(f"a child of {child} cannot weigh {wanted_kg:.1f} kg; {possible}")
    ends_kg = {low: lightest_kg, high: heaviest_kg}  # The search begins there.

    def excess(factor: float) -> float:
        """Return by how much the cube root of the weight is too large; it is closer to a line than the weight is."""
        return math.cbrt(ends_kg[factor] if factor in ends_kg else weigh(factor)) - math.cbrt(wanted_kg)

    return root(excess, low, high, _PRECISION)


def _range(bounds: Bounds, limits: Bounds, unit: str) -> str:
    """Return advice with the range of values, rounded inwards and limited to those that a spec allows."""
    least, largest = max(bounds[0], limits[0]), min(bounds[1], limits[1])
    return f"give {math.ceil(10 * least) / 10:.1f} to {math.floor(10 * largest) / 10:.1f} {unit}"


def _times(bounds: Bounds, factor: float) -> Bounds:
    return bounds[0] * factor, bounds[1] * factor

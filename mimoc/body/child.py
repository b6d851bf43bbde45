"""The child described by a spec: the average child of its age, individualised, with single parts scaled."""

from functools import partial

from mimoc.body.assembly import Anatomy
from mimoc.body.damping import scale_damping
from mimoc.body.growth import grow, grow_average, weigh
from mimoc.body.individual import individualise
from mimoc.body.prune import prune
from mimoc.body.strength import scale_strength
from mimoc.body.tree import BodyTree
from mimoc.fits import Measured, Measurements, measure
from mimoc.schema.infant import InfantSpec
from mimoc.units import cm_to_m


def measure_child(spec: InfantSpec, anatomy: Anatomy) -> Measurements:
    """Return the measurements of a spec's child: those of its age, individualised, and replaced where the spec says so.

    Raises:
        IndividualError: If no child matches the requested individual.
    """
    measurements = measure(spec.age_months)
    if spec.body.individual:
        weight_kg = partial(weigh, anatomy=anatomy, development=spec.development)
        measurements = individualise(measurements, spec.body.individual, weight_kg)
    return replace_given(measurements, spec)


def replace_given(measurements: Measurements, spec: InfantSpec) -> Measurements:
    """Return the measurements, with those that the spec gives replacing the child's own."""
    given = {key.removesuffix("_cm"): _given(key, value_cm) for key, value_cm in spec.body.measurements.items()}
    return measurements.replaced(given) if given else measurements


def grow_child(spec: InfantSpec, measurements: Measurements, anatomy: Anatomy) -> BodyTree:
    """Return the body of a spec's child, with scaled parts, strength and damping, and without removed limbs.

    Raises:
        GeometryError: If no body has these measurements.
    """
    scales = {name: (part.length, part.girth) for name, part in spec.body.parts.items()}
    if measurements is measure(spec.age_months) and not scales:
        grown = grow_average(spec.age_months, anatomy, spec.development)
    else:
        grown = grow(measurements, anatomy, scales, spec.development)
    return prune(scale_damping(scale_strength(grown, anatomy, spec.actuation), anatomy), spec.body.remove)


def _given(key: str, value_cm: float) -> Measured:
    return Measured(cm_to_m(value_cm), "given by the spec", given_by=(f"spec.body.measurements.{key}",))

"""The child of a spec, or the key because of which there is none, and the range of its possible values."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from mimoc.anatomy.anatomy import assemble
from mimoc.base.errors import ContractureError, GeometryError, IndividualError, Problem, SpecError
from mimoc.base.geometry.solvers import root
from mimoc.base.units import m_to_cm
from mimoc.body.grow import GrownBody, grow_body, grow_child, measure_child, reference_of
from mimoc.body.measurements import replace_given
from mimoc.body.reference import CURVES, Reference
from mimoc.fits import measure
from mimoc.schema.base import KeyPath
from mimoc.schema.infant import InfantSpec, as_written, validated
from mimoc.schema.names import unsided

MIN_RATIO, MAX_RATIO = 0.4, 2.0
"""Range of a measurement, relative to the average child's at the same age.

Children born after 22 weeks are .57 times as long as those born at term, weigh .15 times as much (Fenton and Kim 2013,
BMC Pediatrics 13:59), and so have .5 times their girths; their heads have .59 times the girth. Hydrocephalus makes a
newborn's head up to 1.8 times as large (60 cm). Overgrowth and lymphoedema double the girth of a limb.
"""
PRECISION = 1e-7  # Precision of the limit of possible values, relative to its distance from a possible value.
FARTHEST = 0.5  # Smallest value that is tried, relative to the default value; its inverse is the largest.


def checked_or_average(spec: InfantSpec | None) -> InfantSpec:
    """Return a spec that this version can build, or raise a SpecError; of None, that of the average child."""
    infant = validated(spec) if spec else InfantSpec(mimoc=1, name="average_child", age_months=0)
    check_available(infant)
    return infant


def check_available(spec: InfantSpec) -> None:
    """Check that this version can build a spec, whose measurements are a child's; a SpecError lists all problems."""
    if spec.body.measurements and (problems := [*_problems_of_measurements(spec)]):
        raise SpecError(problems)


def _problems_of_measurements(spec: InfantSpec) -> Iterator[Problem]:
    anatomy = assemble(spec.body.hands, spec.body.chest_joint, spec.development, spec.body.extra or ())
    written = as_written(spec)
    average = measure(spec.corrected_age_months, CURVES[spec.development])
    for key, value_cm in spec.body.measurements.items():
        path = ("body", "measurements", key)
        average_cm = m_to_cm(average[unsided(key)])
        if unsided(key) not in anatomy.follows:
            what = f"no part of a {spec.body.hands} body follows it by the law '{spec.development}'; leave it out"
            yield written.problem(path, what, at="key")
        if not MIN_RATIO <= value_cm / average_cm <= MAX_RATIO:
            least_cm, largest_cm = (
                math.ceil(10 * MIN_RATIO * average_cm) / 10,
                math.floor(10 * MAX_RATIO * average_cm) / 10,
            )
            message = (
                f"{value_cm:g} cm is {value_cm / average_cm:.2g} times what the average child of "
                f"{spec.corrected_age_months:g} months has ({average_cm:.1f} cm), and children have {MIN_RATIO:g} to "
                f"{MAX_RATIO:g} times as much; give {least_cm:.1f} to {largest_cm:.1f} cm"
            )
            yield written.problem(path, message)


@dataclass(frozen=True, slots=True)
class Suspect:
    """A number in a spec that may have made its child impossible."""

    path: KeyPath
    value: float
    neutral: float  # Its value if it were not given.

    @property
    def deviation(self) -> float:
        """Deviation from neutral in either direction."""
        return abs(math.log(self.value / self.neutral))

    def replaced(self, spec: InfantSpec, value: float) -> InfantSpec:
        """Return the spec with another value of this key, without validation."""
        section, name, *key = map(str, self.path[1:])
        table = getattr(spec.body, section)
        changed = table[name].model_copy(update={key[0]: value}) if key else value
        body = spec.body.model_copy(update={section: {**table, name: changed}})
        return spec.model_copy(update={"body": body})

    def advise(self, limit: float) -> str:
        """Return advice, given that values between neutral and *limit* are possible."""
        is_measurement = self.path[1] == "measurements"
        is_less = self.value > limit
        digits = 1 if is_measurement else 2
        bound = (math.floor if is_less else math.ceil)(limit * 10**digits) / 10**digits
        if is_measurement:
            return f"give {'less' if is_less else 'more'} than {bound:.1f} cm"
        return f"give a {self.path[-1]} {'below' if is_less else 'above'} {bound:.2f}"


def child_of(spec: InfantSpec, reference: Reference | None = None) -> GrownBody:
    """Return the body of a spec's child; the reference of its anatomy can be given if it is known.

    If there is no such child, a SpecError says which key makes it impossible, and what would be possible.

    """
    try:
        return grow_body(spec, reference)
    except IndividualError as error:
        raise SpecError([as_written(spec).problem(("body", "individual"), str(error))]) from None
    except ContractureError as error:
        path = "impairments", "range", error.movement
        raise SpecError([as_written(spec).problem(path, str(error))]) from None
    except GeometryError as error:
        path, advice = _culprit(spec)
        raise SpecError([as_written(spec).problem(path, f"{error}; {advice}")]) from None


def _culprit(spec: InfantSpec) -> tuple[KeyPath, str]:
    """Return the key of a spec that makes its child impossible, and advice.

    That is the number without which the child would be possible; of several, the one that deviates most from its
    neutral value. The limit of possible values is found by bisection.
    """
    reference = reference_of(spec)
    plain = spec.body.model_copy(update={"measurements": {}, "parts": {}})
    average_m = measure_child(spec.model_copy(update={"body": plain}), reference)

    def is_possible(other: InfantSpec) -> bool:
        try:
            grow_child(other, replace_given(average_m, other), reference)
        except GeometryError:
            return False
        return True

    suspects = [
        Suspect(("body", "parts", name, key), factor, 1.0)
        for name, part in spec.body.parts.items()
        for key, factor in part
    ]
    for key, value_cm in spec.body.measurements.items():
        suspects.append(Suspect(("body", "measurements", key), value_cm, m_to_cm(average_m[unsided(key)])))
    suspects.sort(key=lambda suspect: (-suspect.deviation, suspect.path))
    for farther in (1.0, FARTHEST):
        for suspect in suspects:
            good = suspect.neutral * (farther if suspect.value >= suspect.neutral else 1 / farther)
            if is_possible(suspect.replaced(spec, good)):
                return suspect.path, suspect.advise(_limit(spec, suspect, good, is_possible))
    if suspects:
        return suspects[0].path, "give one that fits the rest of the body"
    return ("body", "individual") if spec.body.individual else ("age_months",), "give one nearer to the average"


def _limit(spec: InfantSpec, suspect: Suspect, good: float, is_possible: Callable[[InfantSpec], bool]) -> float:
    def value(share: float) -> float:
        return good + share * (suspect.value - good)

    def sign(share: float) -> float:
        return -1.0 if is_possible(suspect.replaced(spec, value(share))) else 1.0

    return value(root(sign, 0.0, 1.0, PRECISION, method="bisect") - PRECISION)

"""The child of a spec, or the key because of which there is none, and the range of its possible values."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from mimoc.base.errors import GeometryError, IndividualError, Problem, SpecError
from mimoc.base.units import m_to_cm
from mimoc.body.grow import GrownBody, grow_body, grow_child, measure_child, reference_of
from mimoc.body.measurements import replace_given
from mimoc.body.reference import Reference
from mimoc.geometry.solvers import root
from mimoc.schema.base import KeyPath
from mimoc.schema.infant import InfantSpec, as_written
from mimoc.schema.names import unsided
from mimoc.schema.source import Source

PRECISION = 1e-7
"""Precision of the limit of possible values, relative to its distance from a possible value."""
FARTHEST = 0.5
"""Smallest value that is tried, relative to the default value; its inverse is the largest."""

Possible = Callable[[InfantSpec], bool]


@dataclass(frozen=True, slots=True)
class Suspect:
    """A number in a spec that may have made its child impossible."""

    path: KeyPath
    value: float
    neutral: float
    """Its value if it were not given."""

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
        digits = 1 if self.path[1] == "measurements" else 2
        if self.value > limit:
            bound = f"{math.floor(limit * 10**digits) / 10**digits:.{digits}f}"
            return f"give less than {bound} cm" if digits == 1 else f"give a {self.path[-1]} below {bound}"
        bound = f"{math.ceil(limit * 10**digits) / 10**digits:.{digits}f}"
        return f"give more than {bound} cm" if digits == 1 else f"give a {self.path[-1]} above {bound}"


def diagnose(error: GeometryError | IndividualError, spec: InfantSpec, written: Source) -> Problem:
    """Return the problem, located at the key of the spec that causes an error of the body.

    That is the number without which the child would be possible; of several, the one that deviates most from its
    neutral value. The limit of possible values is found by bisection.

    Args:
        error: The error.
        spec: The spec.
        written: The file of the spec.
    """
    if isinstance(error, IndividualError):
        return written.problem(("body", "individual"), str(error))
    reference = reference_of(spec)
    measurements = measure_child(_plain(spec), reference)

    def is_possible(other: InfantSpec) -> bool:
        try:
            grow_child(other, replace_given(measurements, other), reference)
        except GeometryError:
            return False
        return True

    path, advice = _likeliest(spec, dict(measurements), is_possible)
    return written.problem(path, f"{error}; {advice}")


def _plain(spec: InfantSpec) -> InfantSpec:
    """Return the spec without overrides."""
    return spec.model_copy(update={"body": spec.body.model_copy(update={"measurements": {}, "parts": {}})})


def _likeliest(spec: InfantSpec, average_m: dict[str, float], is_possible: Possible) -> tuple[KeyPath, str]:
    """Return the key that most likely causes the error, and advice."""
    suspects = sorted(_suspects(spec, average_m), key=lambda suspect: (-suspect.deviation, suspect.path))
    for farther in (1.0, FARTHEST):
        for suspect in suspects:
            good = suspect.neutral * (farther if suspect.value >= suspect.neutral else 1 / farther)
            if is_possible(suspect.replaced(spec, good)):
                return suspect.path, suspect.advise(_limit(spec, suspect, good, is_possible))
    if suspects:
        return suspects[0].path, "give one that fits the rest of the body"
    return ("body", "individual") if spec.body.individual else ("age_months",), "give one nearer to the average"


def _suspects(spec: InfantSpec, average_m: dict[str, float]) -> Iterator[Suspect]:
    for name, part in spec.body.parts.items():
        yield from (Suspect(("body", "parts", name, key), factor, 1.0) for key, factor in part)
    for key, value_cm in spec.body.measurements.items():
        yield Suspect(("body", "measurements", key), value_cm, m_to_cm(average_m[unsided(key)]))


def _limit(spec: InfantSpec, suspect: Suspect, good: float, is_possible: Possible) -> float:
    """Return the possible value that is nearest to the given one."""

    def value(share: float) -> float:
        return good + share * (suspect.value - good)

    def sign(share: float) -> float:
        return -1.0 if is_possible(suspect.replaced(spec, value(share))) else 1.0

    change = root(sign, 0.0, 1.0, PRECISION, method="bisect")
    return value(change - PRECISION)


def child_of(spec: InfantSpec, reference: Reference | None = None) -> GrownBody:
    """Return the body of a spec's child.

    Args:
        spec: The spec.
        reference: What children of the same anatomy are compared with, if it is known.

    Raises:
        SpecError: If there is no such child; the error says which key makes it impossible, and what would be possible.
    """
    try:
        return grow_body(spec, reference)
    except (GeometryError, IndividualError) as error:
        raise SpecError([diagnose(error, spec, as_written(spec))]) from None

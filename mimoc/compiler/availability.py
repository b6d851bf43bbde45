"""Check for keys of the spec language that this version of mimoc cannot build, and values that no child has."""

import math
from collections.abc import Iterator

from mimoc.base.errors import Problem, SpecError
from mimoc.base.units import m_to_cm
from mimoc.body.anatomy import assemble
from mimoc.fits import measure
from mimoc.schema.infant import InfantSpec, as_written
from mimoc.schema.names import unsided

LEAST, LARGEST = 0.4, 2.0
"""Range of a measurement, relative to the average child's at the same age.

Children born after 22 weeks are .57 times as long as those born at term, weigh .15 times as much (Fenton and Kim 2013,
BMC Pediatrics 13:59), and so have .5 times their girths; their heads have .59 times the girth. Hydrocephalus makes a
newborn's head up to 1.8 times as large (60 cm). Overgrowth and lymphoedema double the girth of a limb.
"""


def implausible(spec: InfantSpec) -> Iterator[Problem]:
    """Yield a problem for each measurement of a spec that no child of its age has."""
    for key, value_cm in spec.body.measurements.items():
        average_m = measure(spec.age_months).get(unsided(key))
        if average_m is None:
            continue
        average_cm = m_to_cm(average_m)
        if LEAST <= value_cm / average_cm <= LARGEST:
            continue
        least_cm, largest_cm = math.ceil(10 * LEAST * average_cm) / 10, math.floor(10 * LARGEST * average_cm) / 10
        message = (
            f"{value_cm:g} cm is {value_cm / average_cm:.2g} times what the average child of {spec.age_months:g} "
            f"months has ({average_cm:.1f} cm), and children have {LEAST:g} to {LARGEST:g} times as much; "
            f"give {least_cm:.1f} to {largest_cm:.1f} cm"
        )
        yield as_written(spec).problem(("body", "measurements", key), message)


KeyPath = tuple[str, ...]


def check_available(spec: InfantSpec) -> None:
    """Check that this version can build a spec, and that its measurements are a child's.

    Raises:
        SpecError: If not; the error lists everything that is unavailable or implausible.
    """
    problems = [_problem(spec, path, what, advice) for path, what, advice in _unavailable(spec)]
    problems += implausible(spec)
    if problems:
        raise SpecError(problems)


def _unavailable(spec: InfantSpec) -> Iterator[tuple[KeyPath, str, str]]:
    """Yield the path of each unavailable key, what is unavailable, and advice."""
    if not spec.body.measurements:
        return
    anatomy = assemble(spec.body.hands, spec.body.chest_joint, spec.development, spec.body.extra or ())
    for key in spec.body.measurements:
        if unsided(key) not in anatomy.follows:
            yield ("body", "measurements", key), f"a {spec.body.hands} body that follows this", "leave it out"


def _problem(spec: InfantSpec, path: KeyPath, what: str, advice: str) -> Problem:
    message = f"{what} is not available in this version of mimoc; {advice}"
    return as_written(spec).problem(path, message, at="key")

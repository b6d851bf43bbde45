"""Check for keys of the spec language that this version of mimoc cannot build, and values that no child has."""

from collections.abc import Iterator

from mimoc.body import assemble
from mimoc.compiler.plausibility import implausible
from mimoc.errors import Problem, SpecError
from mimoc.schema.infant import InfantSpec, as_written
from mimoc.schema.names import unsided

KeyPath = tuple[str, ...]


def refuse_unavailable(spec: InfantSpec) -> None:
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

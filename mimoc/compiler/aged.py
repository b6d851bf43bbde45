"""The spec of the same child at another age, and errors that concern that age."""

from collections.abc import Iterator
from contextlib import contextmanager

from mimoc.errors import Problem, SpecError
from mimoc.rounding import rounded
from mimoc.schema.base import dotted
from mimoc.schema.infant import InfantSpec, as_written


def aged(spec: InfantSpec, age_months: float) -> InfantSpec:
    """Return the spec of a spec's child at another age (`schema/same_child.py` says what changes).

    Args:
        spec: The child.
        age_months: The age, as it stands in manifests.

    Raises:
        SpecError: If no spec can say so; the error lists all problems.
    """
    return spec if age_months == rounded(spec.age_months) else spec.with_(age_months=age_months)


def quickly_aged(spec: InfantSpec, age_months: float) -> InfantSpec:
    """Return a spec with the same values as `aged`; where one number changes, it is not written as a file is."""
    if spec.body.measurements or spec.body.individual:
        return aged(spec, age_months)
    return spec if age_months == rounded(spec.age_months) else spec.model_copy(update={"age_months": age_months})


@contextmanager
def errors_at(spec: InfantSpec, age_months: float) -> Iterator[None]:
    """Let errors say which age they concern, if it is not the spec's, at the keys that the spec was written with."""
    try:
        yield
    except SpecError as error:
        if age_months == rounded(spec.age_months):
            raise
        written = as_written(spec)
        paths = {dotted(path): path for path in written.key_places}
        raise SpecError(
            written.problem(paths.get(problem.key, ()), f"at {age_months:g} months: {_advised(problem, spec)}")
            for problem in error.problems
        ) from None


def _advised(problem: Problem, spec: InfantSpec) -> str:
    """Return what is wrong at another age; advice on measures is of that age, so that other advice replaces it."""
    if not problem.key.startswith("body."):
        return problem.message
    what, advice = problem.message.rpartition("; ")[0], f"nearer to the average child of {spec.age_months:g} months"
    return f"{what}; leave this age out, or give what is {advice}"

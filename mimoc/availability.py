"""What the spec language can say and this version of mimoc cannot build yet."""

from collections.abc import Iterator

from mimoc.errors import Problem, SpecError
from mimoc.schema import InfantSpec

KeyPath = tuple[str, ...]


def refuse_unavailable(spec: InfantSpec) -> None:
    """Pass a spec that this version can build.

    Raises:
        SpecError: If it asks for more, with everything it asks for in vain.
    """
    problems = [_problem(spec, path, what, advice) for path, what, advice in _unavailable(spec)]
    if problems:
        raise SpecError(problems)


def _unavailable(spec: InfantSpec) -> Iterator[tuple[KeyPath, str, str]]:
    """Yield the path of each key that asks for too much, what it asks for, and what to write instead."""
    leave_out = "leave it out"
    choices = (
        (("body", "hands"), spec.body.hands, ("mitten",)),
        (("actuation", "model"), spec.actuation.model, ("torque",)),
        (("delays", "preset"), spec.delays.preset, ("none",)),
        (("scene", "kind"), spec.scene.kind, ("flat", "empty")),
    )
    for path, value, known in choices:
        if value not in known:
            yield path, f"'{value}'", f"use {' or '.join(known)}"
    sections = (
        (("body", "chest_joint"), spec.body.chest_joint, "a joint in the chest"),
        (("body", "individual"), spec.body.individual, "one child instead of the average one"),
        (("body", "measurements"), spec.body.measurements, "replacing measurements"),
        (("body", "parts"), spec.body.parts, "scaling single parts"),
        (("body", "remove"), spec.body.remove, "removing limbs"),
        (("actuation", "strength_age_months"), spec.actuation.strength_age_months, "a strength of another age"),
        (("actuation", "strength"), spec.actuation.strength, "strength by group"),
        (("senses", "touch"), spec.senses.touch, "touch"),
        (("senses", "vision"), spec.senses.vision, "vision"),
        (("scene", "toys"), spec.scene.toys, "placing toys"),
        (("task",), spec.task, "a task"),
    )
    for path, value, what in sections:
        if value not in (None, False) and value != () and value != {}:
            yield path, what, leave_out
    for key, value in spec.delays:
        if isinstance(value, float) and value > 0:
            yield ("delays", key), "a delay", leave_out


def _problem(spec: InfantSpec, path: KeyPath, what: str, advice: str) -> Problem:
    message = f"{what} is not available in this version of mimoc; {advice}"
    if spec.source:
        return spec.source.problem(path, message, at="key")
    return Problem(f"<{spec.name}>", 0, 0, ".".join(path), message)

"""Servos that hold a commanded angle with the strength of muscles."""

from mimoc.base.kinds import ActuationKind

KIND = ActuationKind(
    name="position",
    about="Servos that hold a commanded angle with the strength of muscles.",
    build="mimoc.actuation.position.build",
    run="mimoc.actuation.position.run",
    command_is_effort=False,
)

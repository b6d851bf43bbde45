"""Servos that hold a commanded angle with the strength of muscles."""

from mimoc.schema.kinds import ActuationKind

KIND = ActuationKind(
    name="position",
    about="Servos that hold a commanded angle with the strength of muscles.",
    build="mimoc.components.actuation.position.build",
    run="mimoc.components.actuation.position.run",
    command_is_effort=False,
)

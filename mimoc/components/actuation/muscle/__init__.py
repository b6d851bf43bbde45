"""Two antagonistic muscles for each joint."""

from mimoc.schema.kinds import ActuationKind

KIND = ActuationKind(
    "muscle",
    "Two antagonistic muscles for each joint.",
    "mimoc.components.actuation.muscle.build",
    "mimoc.components.actuation.muscle.run",
)

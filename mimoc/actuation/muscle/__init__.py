"""Two antagonistic muscles for each joint."""

from mimoc.base.kinds import ActuationKind

KIND = ActuationKind(
    name="muscle",
    about="Two antagonistic muscles for each joint.",
    build="mimoc.actuation.muscle.build",
    run="mimoc.actuation.muscle.run",
)

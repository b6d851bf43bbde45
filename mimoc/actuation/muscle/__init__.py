"""Two antagonistic muscles for each joint."""

from mimoc.base.kinds import ActuationKind

KIND = ActuationKind(
    "muscle", "Two antagonistic muscles for each joint.", "mimoc.actuation.muscle.build", "mimoc.actuation.muscle.run"
)

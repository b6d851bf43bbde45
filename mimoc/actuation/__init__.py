"""What moves an infant's joints: the actuation models, a folder each."""

from mimoc.kinds import ActuationKind, Kinds

ACTUATIONS: Kinds[ActuationKind] = Kinds(
    "actuation model",
    {
        "torque": "mimoc.actuation.torque",
        "muscle": "mimoc.actuation.muscle",
        "position": "mimoc.actuation.position",
    },
)

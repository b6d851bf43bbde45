"""Actuation models, each in its own folder."""

from mimoc.base.kinds import ActuationKind, Kinds

ACTUATIONS: Kinds[ActuationKind] = Kinds(
    "actuation model",
    {
        "torque": "mimoc.actuation.torque",
        "muscle": "mimoc.actuation.muscle",
        "position": "mimoc.actuation.position",
    },
)

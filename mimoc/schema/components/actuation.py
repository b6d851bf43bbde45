"""Actuation models, each in its own folder."""

from mimoc.base.kinds import Kinds
from mimoc.schema.kinds import ActuationKind

ACTUATIONS: Kinds[ActuationKind] = Kinds(
    "actuation model",
    {
        "torque": "mimoc.components.actuation.torque",
        "muscle": "mimoc.components.actuation.muscle",
        "position": "mimoc.components.actuation.position",
    },
)

"""Actuation models; the code of each is a folder."""

from mimoc.base.kinds import Kinds
from mimoc.schema.kinds import ActuationKind

_ABOUT = {
    "torque": "Torque on a spring and damper at each joint.",
    "muscle": "Two antagonistic muscles for each joint.",
    "position": "Servos that hold a commanded angle with the strength of muscles.",
}
_IN = "mimoc.components.actuation"
ACTUATIONS: Kinds[ActuationKind] = Kinds(
    "actuation model",
    {
        name: ActuationKind(
            name, about, f"{_IN}.{name}.build", f"{_IN}.{name}.run", command_is_effort=name != "position"
        )
        for name, about in _ABOUT.items()
    },
)

"""What can be asked of proprioception, and what the runtime must know of it."""

from typing import Annotated, Literal

from mimoc.schema.base import Model
from mimoc.schema.quantities import Distinct

ProprioceptiveQuantity = Literal["velocity", "torque", "limits", "actuation"]


class ProprioceptionSpec(Model):
    """The sense of posture; joint angles are always in it."""

    include: Annotated[tuple[ProprioceptiveQuantity, ...], Distinct] = ("velocity", "torque", "limits", "actuation")
    """What is sensed besides joint angles."""


class ProprioceptionEntry(Model):
    """The sense of posture."""

    kind: Literal["proprioception"] = "proprioception"
    """Which sense this is."""
    include: tuple[ProprioceptiveQuantity, ...]
    """What is sensed besides joint angles, in this order."""
    joints: tuple[str, ...]
    """Hinges, in the order of the observation."""
    torque_sensors: tuple[str, ...]
    """Three-axis torque sensors, in the order of the observation."""

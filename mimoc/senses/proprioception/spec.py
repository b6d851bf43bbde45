"""The options of proprioception, and its entry in the manifest."""

from typing import Annotated, Literal

from mimoc.schema.base import Model
from mimoc.schema.entries import Hinge, Sensor
from mimoc.schema.quantities import Distinct

ProprioceptiveQuantity = Literal["velocity", "torque", "limits", "actuation"]


class ProprioceptionSpec(Model):
    """Proprioception: joint angles, and optionally more."""

    include: Annotated[tuple[ProprioceptiveQuantity, ...], *Distinct] = ("velocity", "torque", "limits", "actuation")
    """Quantities that are observed besides joint angles."""


class ProprioceptionEntry(Model):
    """Proprioception."""

    kind: Literal["proprioception"] = "proprioception"
    """Name of the sense."""
    include: Annotated[tuple[ProprioceptiveQuantity, ...], *Distinct]
    """Quantities that are observed besides joint angles, in this order."""
    joints: Annotated[tuple[Hinge, ...], *Distinct]
    """Hinge joints, in the order of the observation."""
    torque_sensors: Annotated[tuple[Sensor, ...], *Distinct]
    """Three-axis torque sensors, in the order of the observation."""

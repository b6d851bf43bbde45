"""Joint angles, velocities, torques and limits, and the state of the actuators."""

from typing import TYPE_CHECKING, Annotated, Literal

from mimoc.schema.base import Model
from mimoc.schema.entries import Hinge, Sensor
from mimoc.schema.kinds import AGES_MONTHS, AgeTable, NoiseOption, SenseKind
from mimoc.schema.quantities import Distinct

if TYPE_CHECKING:
    from mimoc.body.tree import BodyTree
    from mimoc.compiler.mjcf.scene import Placed

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


def build(spec: ProprioceptionSpec, body: "BodyTree") -> "Placed":
    """Return the entry; every body has the sensors, whether it has the sense or not."""
    from mimoc.compiler.mjcf.scene import Placed
    from mimoc.compiler.mjcf.sensor_sites import torque_sensors

    sensors = tuple(sensor.name for sensor in torque_sensors(body))
    return Placed(ProprioceptionEntry(include=spec.include, joints=tuple(body.joints), torque_sensors=sensors))


KIND = SenseKind(
    name="proprioception",
    spec=ProprioceptionSpec,
    entry=ProprioceptionEntry,
    build=build,
    run="mimoc.components.senses.proprioception.run",
    physiological_delay=AgeTable(AGES_MONTHS, (40, 35, 25, 20, 20, 20), (40, 40, 35, 35, 30, 30)),
    noise=NoiseOption(
        unit="deg",
        about="Standard deviation of each sensed joint angle, or that of the infant's age (`age`) or of adults "
        "(`adult`); sensed velocities have the noise that follows from it.",
        most=45.0,
        run="mimoc.components.senses.proprioception.run:bind_noise",
        by_age=((0.0, 8.0), (3.0, 8.0), (6.0, 6.0), (12.0, 5.0), (24.0, 4.0)),
        adult=2.0,
        source="a guess (D) from adults, 1 to 3 deg, and children of 5 to 10 years, two to three times as much (from "
        "memory); no infant was measured",
        low_pass_ms=500.0,
    ),
)

"""The vestibular sense on a body."""

from mimoc.body.tree import BodyTree
from mimoc.mjcf import sensor_sites
from mimoc.mjcf.scene import Placed
from mimoc.senses.vestibular import VestibularEntry, VestibularSpec


def build(spec: VestibularSpec, body: BodyTree) -> Placed:
    """Return the entry; every body has the sensors, whether it has the sense or not."""
    names = {sensor.kind: sensor.name for sensor in sensor_sites.VESTIBULAR_SENSORS if sensor.kind in spec.include}
    return Placed(VestibularEntry(accelerometer=names.get("accelerometer"), gyro=names.get("gyro")))

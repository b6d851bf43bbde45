"""Proprioception on a body."""

from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf import sensor_sites
from mimoc.compiler.mjcf.scene import Placed
from mimoc.components.senses.proprioception import ProprioceptionEntry, ProprioceptionSpec


def build(spec: ProprioceptionSpec, body: BodyTree) -> Placed:
    """Return the entry; every body has the sensors, whether it has the sense or not."""
    return Placed(
        ProprioceptionEntry(
            include=spec.include,
            joints=tuple(body.joints),
            torque_sensors=tuple(sensor.name for sensor in sensor_sites.torque_sensors(body)),
        )
    )

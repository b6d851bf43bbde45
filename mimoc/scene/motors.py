"""Actuators: how each actuation model drives an infant's joints in MuJoCo."""

from collections.abc import Callable, Mapping

from mimoc.body import BodyTree
from mimoc.scene.tree import Actuator


def torque_motors(tree: BodyTree) -> tuple[Actuator, ...]:
    """Return one motor for each of MIMo's actuators: torque = gear x command, within the force range."""
    return tuple(
        Actuator(motor.name, motor.joint, motor.gear_nm, (-1.0, 1.0), motor.force_range) for motor in tree.motors
    )


MOTORS: Mapping[str, Callable[[BodyTree], tuple[Actuator, ...]]] = {"torque": torque_motors}
"""By actuation model."""

"""Torque motors: torque = gear x command, within the force range."""

from mimoc.actuation.drives import Drive
from mimoc.actuation.muscle.build import parameters
from mimoc.body import BodyTree
from mimoc.mjcf.tree import Actuator

TORQUE = (
    ("forcelimited", "true"),
    ("dyntype", "none"),
    ("gaintype", "fixed"),
    ("gainprm", "1"),
    ("biastype", "none"),
)


def build(spec: None, tree: BodyTree, timestep_s: float) -> Drive:
    """Return one motor for each of MIMo's actuators; the joints keep their springs and dampers."""
    return Drive(torque_motors(tree), TORQUE, "Euler", tree.joints)


def torque_motors(tree: BodyTree) -> tuple[Actuator, ...]:
    """Return one motor for each of MIMo's actuators: torque = gear x command, within the force range.

    Each has the parameters of its muscles with it, for MIMo's code, which makes muscles of torque motors.
    """
    joints = tree.joints
    return tuple(
        Actuator(
            name=motor.name,
            mimo_actuator=motor.name,
            joint=motor.joint,
            gear=motor.gear_nm,
            control_range=(-1.0, 1.0),
            settings=(("forcerange", motor.force_range), ("user", parameters(motor, joints[motor.joint]))),
        )
        for motor in tree.motors
    )

"""Actuators: how each actuation model drives an infant's joints in MuJoCo."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from mimoc.actuation.muscle.build import MUSCLE, limp_joints, muscles, parameters
from mimoc.actuation.position.build import SERVO, held, servo_joints, servos
from mimoc.body import BodyTree, Joint
from mimoc.mjcf.tree import Actuator, Keyframe


@dataclass(frozen=True, slots=True)
class Drive:
    """What an actuation model makes of a body."""

    actuators: Callable[[BodyTree, float], tuple[Actuator, ...]]
    """From the body and the physics step, in [s]."""
    defaults: tuple[tuple[str, str], ...]
    """The attributes that all its actuators have in common."""
    integrator: str
    """MuJoCo's: where actuators damp, one that sees their damping ahead."""
    joints: Callable[[BodyTree], Mapping[str, Joint]]
    """The hinges, by name, with the springs and dampers that it leaves them."""
    keyframe: Callable[[BodyTree, Keyframe], Keyframe]
    """A state with the actuators at rest."""


def torque_motors(tree: BodyTree, timestep_s: float) -> tuple[Actuator, ...]:
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


TORQUE = (
    ("forcelimited", "true"),
    ("dyntype", "none"),
    ("gaintype", "fixed"),
    ("gainprm", "1"),
    ("biastype", "none"),
)


def _as_they_are(tree: BodyTree) -> Mapping[str, Joint]:
    return tree.joints


def _as_it_is(tree: BodyTree, keyframe: Keyframe) -> Keyframe:
    return keyframe


DRIVES: Mapping[str, Drive] = {
    "torque": Drive(torque_motors, TORQUE, "Euler", _as_they_are, _as_it_is),
    "muscle": Drive(muscles, MUSCLE, "implicitfast", limp_joints, _as_it_is),
    "position": Drive(servos, SERVO, "implicitfast", servo_joints, held),
}
"""By actuation model."""

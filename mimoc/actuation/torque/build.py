"""Torque motors: torque = gear x activation, within the force range; under `published`, activation is the command."""

from collections.abc import Iterator

from mimoc.actuation.build_setup import AT_ONCE, ActuationSetup, Origin, activation, activation_origin
from mimoc.actuation.muscle.build import LONGEST, PEAK, SHORTEST, parameters
from mimoc.body.origins import REFERENCE
from mimoc.body.strength import published_fmax
from mimoc.body.tree import BodyTree
from mimoc.mjcf.elements import Actuator

LIMITED = (("forcelimited", "true"),)
MOTOR = (("gaintype", "fixed"), ("gainprm", "1"), ("biastype", "none"))


def build(spec: None, tree: BodyTree, timestep_s: float) -> ActuationSetup:
    """Return one motor for each of MIMo's actuators; the joints keep their springs and dampers."""
    defaults = (*LIMITED, *activation(tree, AT_ONCE), *MOTOR)
    origins = {**activation_origin(tree, published=""), **dict(_origins(tree))}
    return ActuationSetup(torque_motors(tree), defaults, "Euler", tree.joints, origins=origins)


def torque_motors(tree: BodyTree) -> tuple[Actuator, ...]:
    """Return one motor for each of MIMo's actuators: torque = gear x activation, within the force range.

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


def _origins(tree: BodyTree) -> Iterator[tuple[str, Origin]]:
    """Yield where the parameters of muscles come from; all else of a motor is that of the body."""
    stroke = LONGEST - SHORTEST
    rule = f"VMAX ({REFERENCE}), both FMAX = {PEAK:g} x gear x part of forcerange x range of the joint / {stroke:g}"
    for motor in tree.motors:
        at = f"actuator.{motor.name}"
        origin = Origin(rule, (f"{at}.gear", f"{at}.forcerange", f"joint.{motor.joint}.range"))
        yield f"{at}.user", published_fmax(motor, "VMAX, FMAX") if motor.fmax else origin

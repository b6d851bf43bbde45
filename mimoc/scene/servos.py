"""Servos: the command is an angle, which is reached soon and held against gravity, whatever strength that takes."""

from collections.abc import Mapping
from dataclasses import replace

from mimoc.body import BodyTree, Joint, Motor
from mimoc.body.heft import heaviest_inertias
from mimoc.scene.tree import Actuator, Keyframe
from mimoc.units import deg_to_rad

FREQUENCY_RAD_S = 100.0
"""Natural frequency of a joint in its heaviest pose: its own weight bends it by less than half a degree."""
LAG_S = 0.03
"""How far the target is behind the command, and the joint behind the target: both smooth what is commanded."""
FOLLOWING = 0.1
"""Damping of a hinge that only follows others through a tendon, by what its servo would have: none sways."""

SERVO = (
    ("forcelimited", "false"),
    ("actlimited", "false"),
    ("dyntype", "filterexact"),
    ("dynprm", f"{LAG_S}"),
    ("gaintype", "fixed"),
    ("biastype", "affine"),
)


def servos(tree: BodyTree) -> tuple[Actuator, ...]:
    """Return one servo for each of MIMo's actuators: commands from -1 to 1 span the range of its joint."""
    joints, inertias = tree.joints, heaviest_inertias(tree)
    return tuple(_servo(motor, joints[motor.joint], inertias[motor.joint]) for motor in tree.motors)


def servo_joints(tree: BodyTree) -> Mapping[str, Joint]:
    """Return the hinges by name; those without a servo are damped."""
    inertias, driven = heaviest_inertias(tree), {motor.joint for motor in tree.motors}
    return {
        name: joint if name in driven else replace(joint, damping_nms_per_rad=FOLLOWING * _damping(inertias[name]))
        for name, joint in tree.joints.items()
    }


def held(tree: BodyTree, keyframe: Keyframe) -> Keyframe:
    """Return a state whose servos hold its pose."""
    angles_rad = dict(zip(tree.joints, keyframe.qpos[7 : 7 + len(tree.joints)], strict=True))
    commands = []
    for motor in tree.motors:
        middle, half = _range(tree.joints[motor.joint])
        commands.append((angles_rad[motor.joint] - middle) / half)
    return replace(keyframe, settings=(("act", tuple(commands)), ("ctrl", tuple(commands))))


def _servo(motor: Motor, joint: Joint, inertia_kgm2: float) -> Actuator:
    """Return the servo of a joint; it makes up for the joint's own spring and damper."""
    middle, half = _range(joint)
    stiffness = _stiffness(inertia_kgm2)
    at_zero_nm = stiffness * middle - joint.stiffness_nm_per_rad * deg_to_rad(joint.springref_deg)
    by_angle = joint.stiffness_nm_per_rad - stiffness
    by_speed = joint.damping_nms_per_rad - _damping(inertia_kgm2)
    return Actuator(
        name=motor.name,
        mimo_actuator=motor.name,
        joint=motor.joint,
        gear=1.0,
        control_range=(-1.0, 1.0),
        settings=(("gainprm", (stiffness * half,)), ("biasprm", (at_zero_nm, by_angle, by_speed))),
    )


def _stiffness(inertia_kgm2: float) -> float:
    """Return what holds a joint, in N m/rad."""
    return FREQUENCY_RAD_S**2 * inertia_kgm2


def _damping(inertia_kgm2: float) -> float:
    """Return what slows a joint down to its lag, in N m s/rad: beyond critical in any pose."""
    return LAG_S * _stiffness(inertia_kgm2)


def _range(joint: Joint) -> tuple[float, float]:
    """Return middle and half width of a hinge's range, in [rad]."""
    low, high = map(deg_to_rad, joint.range_deg)
    return (low + high) / 2, (high - low) / 2

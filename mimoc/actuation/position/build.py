"""Servos: the command is an angle, which is gone to and held as well as the strength of an infant's muscles allows.

A servo has the torque limits of the motor it stands for, and its joint has a damper that eats up all of that torque
at the speed at which the muscles there no longer pull. So force and speed are finite, in plain MuJoCo too.

What that strength can hold against gravity is held within 3.5 degrees, 6.5 with physics steps of 20 ms, from 1.5 s
after the command at the latest; most joints are within half of that. What it cannot hold sags: up to two fifths of a
newborn's joints, whose muscles are weak against its limbs, a tenth of them from 9 months on. A joint may go up to 8
degrees past its target on the way. (`tests/actuation/position/test_build.py`)

A servo has no activation beside its target, which follows the command within 30 ms under either law. Its torque rises
within milliseconds, as that of a muscle that resists being moved, but what is commanded takes as long as with muscles
that need 60 ms to become active: 60 degrees of elbow, shoulder and knee take .22 s on average over 0, 6 and 18 months,
with muscles .19 s. A target that follows within 60 ms would make that .25 s.
(`tests/actuation/test_activation.py`)
"""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import partial

from mimoc.actuation.muscle.build import LONGEST, SHORTEST
from mimoc.actuation.position.inertia import inertias
from mimoc.actuation.position.origins import FINEST_STEP_S, LAG_S, STEPS_OF_LAG, servo_origins
from mimoc.actuation.setup import ActuationSetup
from mimoc.body import BodyTree, Joint, Motor
from mimoc.mjcf.infant import Actuator
from mimoc.mjcf.scene import Keyframe
from mimoc.mujoco_layout import AffineBias
from mimoc.units import deg_to_rad

SERVO = (
    ("forcelimited", "true"),
    ("actlimited", "false"),
    ("dyntype", "filterexact"),
    ("dynprm", f"{LAG_S}"),
    ("gaintype", "fixed"),
    ("biastype", "affine"),
)


def build(spec: None, tree: BodyTree, timestep_s: float) -> ActuationSetup:
    """Return one servo for each of MIMo's actuators, on joints that are damped to the speed of muscles."""
    return ActuationSetup(
        actuators=servos(tree, timestep_s),
        defaults=SERVO,
        integrator="implicitfast",
        joints=servo_joints(tree),
        at_rest=partial(held, tree),
        origins=dict(servo_origins(tree)),
    )


def servos(tree: BodyTree, timestep_s: float) -> tuple[Actuator, ...]:
    """Return one servo for each of MIMo's actuators: commands from -1 to 1 span the range of its joint.

    Args:
        tree: The body.
        timestep_s: Of the physics; the longer, the softer are the servos, so that none of them shakes.
    """
    joints, inertias_kgm2, step_s = tree.joints, inertias(tree), max(timestep_s, FINEST_STEP_S)
    return tuple(_servo(motor, joints[motor.joint], *inertias_kgm2[motor.joint], step_s) for motor in tree.motors)


def servo_joints(tree: BodyTree) -> Mapping[str, Joint]:
    """Return the hinges by name, with dampers that keep what is driven from going faster than muscles could."""
    joints = dict(tree.joints)
    for motor in tree.motors:
        joint = joints[motor.joint]
        joints[motor.joint] = replace(joint, damping_nms_per_rad=_damping(motor, joint))
    return joints


def held(tree: BodyTree, keyframe: Keyframe) -> Keyframe:
    """Return a state whose servos hold its pose."""
    angles_rad = dict(zip(tree.joints, keyframe.qpos[7 : 7 + len(tree.joints)], strict=True))
    commands = []
    for motor in tree.motors:
        middle, half = _range(tree.joints[motor.joint])
        commands.append((angles_rad[motor.joint] - middle) / half)
    return replace(keyframe, settings=(("act", tuple(commands)), ("ctrl", tuple(commands))))


def _servo(motor: Motor, joint: Joint, least_kgm2: float, largest_kgm2: float, step_s: float) -> Actuator:
    """Return the servo of a joint; it makes up for the joint's own spring.

    What it damps by itself would stop the joint at its lightest within one physics step, and no more than that: MuJoCo
    damps as of the next step, but not where a force is cut off.
    """
    middle, half = _range(joint)
    damping = least_kgm2 / step_s
    lag_s = max(LAG_S, STEPS_OF_LAG * step_s, _braking_s(motor, joint, largest_kgm2))
    stiffness = (damping + _damping(motor, joint)) / lag_s
    at_zero_nm = stiffness * middle - joint.stiffness_nm_per_rad * deg_to_rad(joint.springref_deg)
    low, high = motor.force_range
    return Actuator(
        name=motor.name,
        mimo_actuator=motor.name,
        joint=motor.joint,
        gear=1.0 if motor.gear_nm else 0.0,
        control_range=(-1.0, 1.0),
        settings=(
            ("forcerange", (low * (motor.gear_nm or 1.0), high * (motor.gear_nm or 1.0))),
            ("gainprm", (stiffness * half,)),
            ("biasprm", AffineBias(at_zero_nm, joint.stiffness_nm_per_rad - stiffness, -damping)),
        ),
    )


def _braking_s(motor: Motor, joint: Joint, inertia_kgm2: float) -> float:
    """Return how far ahead a servo has to brake: half of the time from the fastest it gets to a stand.

    That is what its damper lets it, or what it gains over half of its joint's range.
    """
    weaker_nm = motor.gear_nm * min(map(abs, motor.force_range))
    if not weaker_nm:
        return 0.0
    _, half = _range(joint)
    reached_rad_s = math.sqrt(2 * half * weaker_nm / inertia_kgm2)
    return min(reached_rad_s, weaker_nm / _damping(motor, joint)) * inertia_kgm2 / weaker_nm / 2


def _damping(motor: Motor, joint: Joint) -> float:
    """Return the joint's own damping, or what takes up its motor's peak torque at the speed of its muscles.

    A muscle is as long as .75 to 1.05 optimal lengths over the range of its joint, and does not pull at VMAX lengths a
    second (MIMo).
    """
    _, half = _range(joint)
    fastest_rad_s = motor.vmax_lengths_per_s * 2 * half / (LONGEST - SHORTEST)
    return max(joint.damping_nms_per_rad, motor.gear_nm * max(map(abs, motor.force_range)) / fastest_rad_s)


def _range(joint: Joint) -> tuple[float, float]:
    """Return middle and half width of a hinge's range, in [rad]."""
    low, high = map(deg_to_rad, joint.range_deg)
    return (low + high) / 2, (high - low) / 2

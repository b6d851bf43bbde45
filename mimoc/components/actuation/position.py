"""Servos: the command is an angle, which is gone to and held as well as the strength of an infant's muscles allows.

A servo has the torque limits of the motor it stands for, the muscle tone of a quiet infant within them, and its joint
has a damper that eats up all of that torque at the speed at which the muscles there no longer pull. So force and speed
are finite, in plain MuJoCo too.

What that strength can hold against gravity is held within 3.5 degrees, 6.5 with physics steps of 20 ms, 1.4 times as
many by newborns with their muscle tone, from 1.5 s after the command at the latest; most joints are within half of
that. What it cannot hold sags: up to two fifths of a newborn's joints, whose muscles are weak against its limbs, a
seventh of them at 9 months. A joint may go up to 8
degrees past its target on the way. (`tests/components/actuation/test_position.py`)

A servo has no activation beside its target, which follows the command within 30 ms under either law. Its torque rises
within milliseconds, as that of a muscle that resists being moved, but what is commanded takes as long as with muscles
that need 60 ms to become active: 60 degrees of elbow, shoulder and knee take .22 s on average over 0, 6 and 18 months,
with muscles .19 s. A target that follows within 60 ms would make that .25 s.
(`tests/components/actuation/test_activation.py`)
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np

from mimoc.base.mujoco_layout import AffineBias
from mimoc.body.kinematics import hinges, pose
from mimoc.body.origins import REFERENCE
from mimoc.body.strength import FASTEST_RAD_S, tone_origin
from mimoc.body.tree import BodyTree, Geom, Joint, Motor
from mimoc.compiler.actuation import EYES_S, ActuationSetup, Origin, quick_joints
from mimoc.compiler.mjcf.elements import Actuator
from mimoc.compiler.mjcf.scene import Keyframe
from mimoc.components.actuation.muscle import MIMOS, hinge_tone

POSES = 4  # Number of sampled poses, distributed evenly over the ranges of all joints.


def inertias(tree: BodyTree) -> Mapping[str, tuple[float, float]]:
    """Return the smallest and the largest inertia about each joint over sampled poses, with armature, in [kg m²].

    In other poses it is hardly less than half of the smallest returned; in one of hundreds, a third.
    """
    joints, by_pose, moved_by = tree.joints, [], _moved(tree)
    moved = np.array([[body.name in moved_by[joint] for body in tree.bodies for _ in body.geoms] for joint in joints])
    for angles_rad in _spread_poses(tree):
        anchors, axes = (np.array(column) for column in zip(*hinges(tree, angles_rad).values(), strict=True))
        # The inertia about each joint's axis of all parts that it moves, shape (joints,).
        posed = pose(tree, angles_rad)
        masses = np.array([geom.mass_kg for geom in posed.geoms])
        arms = np.cross(posed.centres - anchors[:, None], axes[:, None])
        gyrations = np.array([_gyration_squares(geom) for geom in posed.geoms])
        local = np.einsum("gij,ki->kgj", posed.rotations, axes)
        squares = (arms**2).sum(axis=2) + (local**2 * gyrations).sum(axis=2)
        by_pose.append((moved * masses * squares).sum(axis=1))
    armatures = np.array([joint.armature_kgm2 for joint in joints.values()])
    least, largest = np.min(by_pose, axis=0) + armatures, np.max(by_pose, axis=0) + armatures
    return dict(zip(joints, zip(least.tolist(), largest.tolist(), strict=True), strict=True))


def _spread_poses(tree: BodyTree) -> list[dict[str, float]]:
    """Return angles of all joints, in [rad], within their ranges: points of an additive recurrence (Kronecker).

    Left and right get the same angles, regardless of the order of joints, so that their inertias are equal.
    """
    joints = sorted({_sideless(name) for name in tree.joints})
    steps = dict(zip(joints, np.sqrt(np.arange(2, 2 + len(joints)) + 0.5) % 1, strict=True))
    return [
        {
            name: math.radians(low + (0.5 + number * float(steps[_sideless(name)])) % 1 * (high - low))
            for name, (low, high) in ((name, joint.range_deg) for name, joint in tree.joints.items())
        }
        for number in range(POSES)
    ]


def _sideless(joint: str) -> str:
    return joint.replace("left_", "").replace("right_", "")


def _moved(tree: BodyTree) -> dict[str, list[str]]:
    above: dict[str | None, list[str]] = {None: []}
    moved: dict[str, list[str]] = {joint: [] for joint in tree.joints}
    for body in tree.bodies:
        above[body.name] = [*above[body.parent], *(joint.name for joint in body.joints)]
        for joint in above[body.name]:
            moved[joint].append(body.name)
    return moved


def _gyration_squares(geom: Geom) -> tuple[float, float, float]:
    """Return the squared radii of gyration about a geom's axes, in [m²]; a capsule is treated as its cylinder."""
    if geom.type == "box":
        x, y, z = (half_m**2 / 3 for half_m in geom.size_m)
        return y + z, x + z, x + y
    if geom.type == "ellipsoid":
        x, y, z = (half_m**2 / 5 for half_m in geom.size_m)
        return y + z, x + z, x + y
    if geom.type == "sphere":
        square = 0.4 * geom.size_m[0] ** 2
        return square, square, square
    radius_m, half_m = geom.size_m
    across = radius_m**2 / 4 + half_m**2 / 3
    return across, across, radius_m**2 / 2


LAG_S = 0.03
"""Time constant with which the target follows the command, and least time by which the joint is behind the target; both
smooth what is commanded."""
STEPS_OF_LAG = 2  # The least number of physics steps by which a joint is behind its target.
FINEST_STEP_S = 0.005  # Shorter physics steps make no stiffer servos.

MODEL_KEY, STEP_KEY = "spec.actuation.model", "spec.control.timestep_ms"
_DAMPING = (
    f"peak torque / speed at which its muscles do not pull (vmax ({REFERENCE}) x range / {MIMOS.width:.2f}), "
    "where that is more than the joint has with torque motors"
)
_MATURING_DAMPING = (
    f"that of the joint with torque motors + peak torque / {FASTEST_RAD_S:g} rad/s, at which muscles no longer pull (D)"
)
_STOP = f"least inertia about the joint / physics step (of {1000 * FINEST_STEP_S:g} ms at least)"
_STIFFNESS = f"({_STOP} + damping of the joint) / lag ({LAG_S:g} s, and {STEPS_OF_LAG} physics steps at least)"


def servo_origins(tree: BodyTree) -> Iterator[tuple[str, Origin]]:
    """Yield where each number of the servos comes from, and of the joints' dampers, by key."""
    damping = _MATURING_DAMPING if tree.growth else _DAMPING
    for joint in tree.joints:
        gears = (f"actuator.{motor.name}.gear" for motor in tree.motors if motor.joint == joint)
        yield f"joint.{joint}.damping", Origin(damping, (MODEL_KEY, *gears, f"joint.{joint}.range"))
    moved = _moved(tree)
    for motor in tree.motors:
        low, high = motor.force_range
        at = f"actuator.{motor.name}"
        constants = ("range", "stiffness", "springref", "damping", "armature")
        masses = (f"body.{body}.mass" for body in moved[motor.joint])
        gains = (*(f"joint.{motor.joint}.{constant}" for constant in constants), STEP_KEY, *masses)
        limits = (
            f"gear x part of it that is reached towards negative and positive angles: {low:.6g} and {high:.6g} "
            f"({REFERENCE})"
        )
        bias = f"torque at angle 0, then by angle: -{_STIFFNESS}, less the joint's own spring, and by speed: -{_STOP}"
        yield f"{at}.forcerange", Origin(limits, (f"{at}.gear",), "N m")
        yield f"{at}.gainprm", Origin(f"{_STIFFNESS} x half of the joint's range", gains)
        origin = Origin(bias, gains)
        if tree.growth:
            tone = tone_origin(motor)
            origin = origin.times(f"; {tone.rule}, x arousal", *tone.sources)
        yield f"{at}.biasprm", origin


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

    The longer the physics timestep, the softer are the servos, so that none of them shakes.
    """
    joints = tree.joints
    quick = quick_joints(tree)
    step_s = max(timestep_s, FINEST_STEP_S)
    lags_s = {name: EYES_S if name in quick else LAG_S for name in joints}
    inertias_kgm2 = inertias(tree)
    return tuple(
        _servo(motor, joints[motor.joint], *inertias_kgm2[motor.joint], step_s, lags_s[motor.joint])
        for motor in tree.motors
    )


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


def _servo(motor: Motor, joint: Joint, least_kgm2: float, largest_kgm2: float, step_s: float, lag_s: float) -> Actuator:
    """Return the servo of a joint; it makes up for the joint's own spring.

    What it damps by itself would stop the joint at its lightest within one physics step, and no more than that: MuJoCo
    damps as of the next step, but not where a force is cut off.
    """
    middle, half = _range(joint)
    damping = least_kgm2 / step_s
    lag_s = max(lag_s, STEPS_OF_LAG * step_s, _braking_s(motor, joint, largest_kgm2))
    stiffness = (damping + _damping(motor, joint)) / lag_s
    at_zero_nm = stiffness * middle - joint.stiffness_nm_per_rad * math.radians(joint.springref_deg)
    by_angle = joint.stiffness_nm_per_rad - stiffness
    tone = _tone(motor)
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
            ("biasprm", AffineBias(at_zero_nm + tone.at_zero, by_angle + tone.by_length, -damping)),
        ),
        tone=tone if motor.fastest_rad_s else (),
    )


def _tone(motor: Motor) -> AffineBias:
    stiffness, moment_nm = hinge_tone(motor) or (0.0, 0.0)
    return AffineBias(moment_nm, -stiffness, 0.0)


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
    """Return the joint's own damping, with what takes up its motor's peak torque at the speed of its muscles.

    By the law `maturing`, muscles no longer pull at the fastest speed of every joint. By the published law, a muscle is
    as long as .75 to 1.05 optimal lengths over the range of its joint, does not pull at VMAX lengths a second (MIMo),
    and the larger of the two counts.
    """
    peak_nm = motor.gear_nm * max(map(abs, motor.force_range))
    if motor.fastest_rad_s:
        return joint.damping_nms_per_rad + peak_nm / motor.fastest_rad_s
    _, half = _range(joint)
    fastest_rad_s = motor.vmax_lengths_per_s * 2 * half / MIMOS.width
    return max(joint.damping_nms_per_rad, peak_nm / fastest_rad_s)


def _range(joint: Joint) -> tuple[float, float]:
    low, high = map(math.radians, joint.range_deg)
    return (low + high) / 2, (high - low) / 2

"""Torque motors: torque = gear x activation, within the force range; under `published`, activation is the command.

Under `maturing`, a motor also has what quiet muscles do at a joint angle q and speed w, in proportion to arousal,

    torque = gear x activation - k (q - q_0) - T w / w_0

within the same force range, with the muscle tone k, q_0 (`mimoc.body.strength`), the torque T at full command, and the
speed w_0 at which a fully activated motor no longer pulls. Where it helps the movement, this is Hill's curve as a
straight line; where it does not, muscles resist with what is left of the force range. It is none of the joint's: a
slack infant (arousal 0) swings freely. A damper with the cube of speed would be nearer to no force at small speeds, but
MuJoCo reads it from 3.7 on, and two muscles with Hill's curve would take two commands.
"""

import math
from collections.abc import Iterator

from mimoc.base.mujoco_layout import AffineBias
from mimoc.body.origins import REFERENCE
from mimoc.body.strength import published_fmax, tone_origin
from mimoc.body.tree import BodyTree, Joint, Motor
from mimoc.compiler.actuation import AT_ONCE, ActuationSetup, Origin, activation, activation_origin
from mimoc.compiler.mjcf.elements import Actuator
from mimoc.components.actuation.muscle import MIMOS, parameters

LIMITED = (("forcelimited", "true"),)
NO_BIAS, AFFINE = ("biastype", "none"), ("biastype", "affine")
MOTOR = (("gaintype", "fixed"), ("gainprm", "1"), NO_BIAS)


def build(spec: None, tree: BodyTree, timestep_s: float) -> ActuationSetup:
    """Return one motor for each of MIMo's actuators; the joints keep their springs and dampers."""
    defaults = (*LIMITED, *activation(tree, AT_ONCE), *MOTOR)
    origins = {**activation_origin(tree, published=""), **dict(_origins(tree))}
    if tree.growth:
        defaults = tuple(AFFINE if attribute == NO_BIAS else attribute for attribute in defaults)
    return ActuationSetup(torque_motors(tree), defaults, "Euler", tree.joints, origins=origins)


def torque_motors(tree: BodyTree) -> tuple[Actuator, ...]:
    """Return one motor for each of MIMo's actuators: torque = gear x activation, within the force range.

    Each has the parameters of its muscles with it, for MIMo's code, which makes muscles of torque motors.
    """
    joints = tree.joints
    return tuple(_motor(motor, joints[motor.joint], bool(tree.growth)) for motor in tree.motors)


def _motor(motor: Motor, joint: Joint, has_tone: bool) -> Actuator:
    settings = (("forcerange", motor.force_range), ("user", parameters(motor, joint)))
    tone = _tone(motor) if has_tone else ()
    return Actuator(
        name=motor.name,
        mimo_actuator=motor.name,
        joint=motor.joint,
        gear=motor.gear_nm,
        control_range=(-1.0, 1.0),
        settings=(*settings, ("biasprm", tone)) if tone else settings,
        tone=tone,
    )


def _tone(motor: Motor) -> AffineBias:
    """Return the bias of a quiet infant's motor: MuJoCo's force is in gears, and its length is gear x angle."""
    gear = motor.gear_nm
    if not gear:
        return AffineBias(0.0, 0.0, 0.0)
    stiffness, angle_rad = (
        (motor.tone.stiffness_nm_per_rad, math.radians(motor.tone.angle_deg)) if motor.tone else (0, 0)
    )
    peak = max(map(abs, motor.force_range))
    braking = peak / motor.fastest_rad_s if motor.fastest_rad_s else 0.0
    return AffineBias(stiffness * angle_rad / gear, -stiffness / gear**2, -braking / gear)


def _origins(tree: BodyTree) -> Iterator[tuple[str, Origin]]:
    """Yield where the parameters of muscles come from; all else of a motor is that of the body."""
    fmax = f"{MIMOS.peak:g} x gear x part of forcerange x range of the joint / {MIMOS.width:g}"
    rule = f"VMAX ({REFERENCE}), both FMAX = {fmax}"
    for motor in tree.motors:
        at = f"actuator.{motor.name}"
        origin = Origin(rule, (f"{at}.gear", f"{at}.forcerange", f"joint.{motor.joint}.range"))
        if tree.growth:
            speed = f"torque at full command / {motor.fastest_rad_s:g} rad/s, as of shortening muscles (D)"
            yield f"{at}.biasprm", tone_origin(motor).times(f"; by speed, {speed}; x arousal", f"{at}.gear")
        yield f"{at}.user", published_fmax(motor, "VMAX, FMAX") if motor.fmax else origin

"""Muscles: two antagonists for each of MIMo's actuators, in MuJoCo's own muscle model.

Under `published`, muscles leave nothing of a joint's spring, as in MIMo; under `maturing` the relaxed joint is there
with them. Its muscle tone is a spring of the joint, in proportion to arousal, and no least activation: MuJoCo's muscles
have neither short-range stiffness nor stretch reflexes, so that their torque hardly changes over the range of a joint.
A least activation of the flexor would bend a newborn's elbow all the way, and of both antagonists, to hold it at 90
degrees as stiffly as tone does, would take more than all of their strength.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from mimoc.base.mujoco_layout import MuscleParameters
from mimoc.body.origins import LAW_KEY, REFERENCE
from mimoc.body.strength import published_fmax, tone_origin
from mimoc.body.tree import BodyTree, Joint, Motor
from mimoc.compiler.actuation import ActuationSetup, Origin, activation, activation_origin, with_tone
from mimoc.compiler.mjcf.elements import Actuator


@dataclass(frozen=True, slots=True)
class Stroke:
    """Over which lengths a muscle works, and how strong it then is."""

    shortest: float  # Length at one end of its joint's range, in optimal lengths.
    longest: float  # Length at the other end, in optimal lengths.
    peak: float
    """Largest isometric torque, at the optimal length, by the limit of the torque motor that the muscle stands for: so
    chosen that in the middle of the joint's range both antagonists reach the limit."""

    @property
    def width(self) -> float:
        """By how much a muscle shortens over the joint's range, in optimal lengths."""
        return self.longest - self.shortest


MIMOS = Stroke(0.75, 1.05, 1.07)  # MIMo's own, which halves the torque of a shortened muscle.
MATURING = Stroke(0.85, 1.05, 1.02)
"""By the law `maturing`: a shortened muscle keeps four fifths of its torque, so that the neck's holds the head up as a
motor does. Fitted to the age of lifting the head while prone (D)."""
MIN_ACTIVE, MAX_ACTIVE = 0.5, 1.6  # Lengths between which a muscle is active.
SCALE = 200.0  # MuJoCo scales forces by it that are not given; ours are.
PASSIVE_FORCE, LENGTHENING_FORCE = 1.3, 1.2
"""Largest forces of a stretched muscle at rest and of an active one that is being lengthened, by its isometric one."""

UNLIMITED = (("forcelimited", "false"),)
MUSCLE = (("gaintype", "muscle"), ("biastype", "muscle"))
PUBLISHED_S = 0.01  # Time constant of the activation under `published`, as in MIMo's muscle model.

MODEL_KEY = "spec.actuation.model"
DAMPING = 1 / 20
"""What muscles leave of the damping of joints, by the reference body's; of their springs they leave nothing (MIMo)."""


def build(spec: None, tree: BodyTree, timestep_s: float) -> ActuationSetup:
    """Return two muscles for each of MIMo's actuators, which alone move and stiffen the joints."""
    defaults = (*UNLIMITED, *activation(tree, PUBLISHED_S), *MUSCLE)
    origins = {**activation_origin(tree, published="MIMo's muscles"), **dict(_origins(tree))}
    return ActuationSetup(muscles(tree), defaults, "implicitfast", limp_joints(tree), origins=origins)


def muscles(tree: BodyTree) -> tuple[Actuator, ...]:
    """Return both muscles of each of MIMo's actuators, the one towards negative angles first."""
    joints = tree.joints
    return tuple(muscle for motor in tree.motors for muscle in _antagonists(motor, joints[motor.joint], _stroke(tree)))


def _stroke(tree: BodyTree) -> Stroke:
    return MATURING if tree.growth else MIMOS


def limp_joints(tree: BodyTree) -> Mapping[str, Joint]:
    """Return the hinges by name: with muscle tone, or, by the published law, moved and stiffened by muscles alone."""
    if tree.growth:
        joints = dict(tree.joints)
        for motor in tree.motors:
            if tone := hinge_tone(motor):
                joints[motor.joint] = with_tone(joints[motor.joint], *tone)
        return joints
    return {
        name: replace(joint, stiffness_nm_per_rad=0.0, damping_nms_per_rad=DAMPING * joint.damping_nms_per_rad)
        for name, joint in tree.joints.items()
    }


def hinge_tone(motor: Motor) -> tuple[float, ...]:
    """Return stiffness and stiffness x rest angle of the muscle tone at a motor's joint; nothing without tone."""
    if motor.tone is None:
        return ()
    stiffness = motor.tone.stiffness_nm_per_rad
    return stiffness, stiffness * math.radians(motor.tone.angle_deg)


def parameters(motor: Motor, joint: Joint, stroke: Stroke = MIMOS) -> tuple[float, float, float]:
    """Return VMAX and both FMAX of the muscles in a motor's place, as MIMo's own muscle model wants them.

    VMAX is in optimal lengths a second. FMAX, of the muscle towards negative angles and of the other, is torque by
    moment arm, which in MIMo's model is the same all over the range of a joint. By the published law it is MIMo's at
    every age.
    """
    arm = _moment_arm(joint, stroke)
    if motor.fmax:
        negative, positive = motor.fmax
    else:
        negative, positive = (stroke.peak * motor.gear_nm * abs(share) / arm for share in motor.force_range)
    # As fast as with MIMo's; by the law `maturing` at least as fast as any, since newborns could not kick with MIMo's.
    vmax = max(motor.vmax_lengths_per_s * stroke.width / MIMOS.width, (motor.fastest_rad_s or 0.0) * arm)
    return vmax, negative, positive


def _moment_arm(joint: Joint, stroke: Stroke) -> float:
    """Return by how much the muscles of a joint shorten, in optimal lengths, when it turns by a radian."""
    low, high = map(math.radians, joint.range_deg)
    return stroke.width / (high - low)


def _antagonists(motor: Motor, joint: Joint, stroke: Stroke) -> Iterator[Actuator]:
    low, high = map(math.radians, joint.range_deg)
    fastest, *forces = parameters(motor, joint, stroke)
    negative, positive = (_curve(stroke, force * _moment_arm(joint, stroke), fastest) for force in forces)
    yield replace(_muscle(motor, "negative", 1.0, (low, high), negative), tone=hinge_tone(motor))
    yield _muscle(motor, "positive", -1.0, (-high, -low), positive)


def _curve(stroke: Stroke, torque_nm: float, fastest: float) -> MuscleParameters:
    return MuscleParameters(
        shortest=stroke.shortest,
        longest=stroke.longest,
        force=torque_nm,
        scale=SCALE,
        least_active=MIN_ACTIVE,
        most_active=MAX_ACTIVE,
        vmax=fastest,
        passive=PASSIVE_FORCE,
        lengthening=LENGTHENING_FORCE,
    )


def _muscle(
    motor: Motor, direction: str, gear: float, length_rad: tuple[float, float], curve: MuscleParameters
) -> Actuator:
    """Return a muscle that pulls a joint one way; *length_rad* is its length over the joint's range."""
    return Actuator(
        name=f"{motor.name}_{direction}",
        mimo_actuator=motor.name,
        joint=motor.joint,
        gear=gear,
        control_range=(0.0, 1.0),
        settings=(("lengthrange", length_rad), ("gainprm", curve), ("biasprm", curve)),
    )


def _origins(tree: BodyTree) -> Iterator[tuple[str, Origin]]:
    damping = f"{DAMPING:g} x that of {REFERENCE}; the same at every age by the law `published`"
    for name in () if tree.growth else tree.joints:
        yield f"joint.{name}.stiffness", Origin("none with muscles, as in MIMo", (MODEL_KEY, LAW_KEY))
        yield f"joint.{name}.damping", Origin(damping, (MODEL_KEY, LAW_KEY))
    for motor in tree.motors:
        if motor.tone:
            rule = "the relaxed joint's, and with muscles, as a spring, " + tone_origin(motor).rule + ", x arousal"
            yield f"joint.{motor.joint}.stiffness", Origin(rule, (MODEL_KEY, *tone_origin(motor).sources))
            yield f"joint.{motor.joint}.springref", Origin(rule, (MODEL_KEY, *tone_origin(motor).sources))
    motors = {motor.name: motor for motor in tree.motors}
    for muscle in muscles(tree):
        motor = motors[muscle.mimo_actuator]
        at = f"actuator.{muscle.name}"
        strength = f"actuator.{motor.name}.gear", f"actuator.{motor.name}.forcerange"
        torque = Origin(f"{_stroke(tree).peak:g} x gear x part of forcerange", strength)
        if motor.fmax:
            torque = published_fmax(motor, "FMAX")
        fastest = f", at least {motor.fastest_rad_s:g} rad/s of the joint; D" if motor.fastest_rad_s else ""
        curve = (
            f"lengths at the ends of the joint's range, largest isometric torque in N m = {torque.rule}, MuJoCo's "
            f"scale, lengths where active, vmax ({REFERENCE}{fastest}), passive and lengthening force"
        )
        yield f"{at}.gainprm", Origin(curve, torque.sources)
        yield f"{at}.biasprm", Origin(curve, torque.sources)
        length = "the range of its joint, as it pulls"
        yield f"{at}.lengthrange", Origin(length, (f"joint.{motor.joint}.range",), "rad")

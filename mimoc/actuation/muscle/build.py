"""Muscles: two antagonists for each of MIMo's actuators, in MuJoCo's own muscle model."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

from mimoc.actuation.drives import Drive
from mimoc.body import BodyTree, Joint, Motor
from mimoc.mjcf.tree import Actuator
from mimoc.units import deg_to_rad

PEAK = 1.07
"""Largest isometric torque of a muscle, at its optimal length, by the limit of the torque motor it stands for: what
MIMo's muscles have, so that in the middle of a joint's range both of them reach the limit."""
SHORTEST, LONGEST = 0.75, 1.05
"""Length of a muscle at the ends of its joint's range, in optimal lengths."""
LEAST_ACTIVE, MOST_ACTIVE = 0.5, 1.6
"""Lengths between which a muscle is active."""
SCALE = 200.0
"""MuJoCo scales forces by it that are not given; ours are."""
PASSIVE_FORCE, LENGTHENING_FORCE = 1.3, 1.2
"""Largest forces of a stretched muscle at rest and of an active one that is being lengthened, by its isometric one."""

MUSCLE = (
    ("forcelimited", "false"),
    ("actlimited", "false"),
    ("dyntype", "filterexact"),
    ("dynprm", "0.01"),
    ("gaintype", "muscle"),
    ("biastype", "muscle"),
)
"""Activation follows the command within 10 ms."""

DAMPING = 1 / 20
"""What muscles leave of the damping of joints, by the reference body's; of their springs they leave nothing (MIMo)."""


def build(spec: None, tree: BodyTree, timestep_s: float) -> Drive:
    """Return two muscles for each of MIMo's actuators, which alone move and stiffen the joints."""
    return Drive(muscles(tree), MUSCLE, "implicitfast", limp_joints(tree))


def muscles(tree: BodyTree) -> tuple[Actuator, ...]:
    """Return both muscles of each of MIMo's actuators, the one towards negative angles first."""
    joints = tree.joints
    return tuple(muscle for motor in tree.motors for muscle in _antagonists(motor, joints[motor.joint]))


def limp_joints(tree: BodyTree) -> Mapping[str, Joint]:
    """Return the hinges by name; only muscles move and stiffen them."""
    return {
        name: replace(joint, stiffness_nm_per_rad=0.0, damping_nms_per_rad=DAMPING * joint.damping_nms_per_rad)
        for name, joint in tree.joints.items()
    }


def parameters(motor: Motor, joint: Joint) -> tuple[float, float, float]:
    """Return VMAX and both FMAX of the muscles in a motor's place, as MIMo's own muscle model wants them.

    VMAX is in optimal lengths a second. FMAX, of the muscle towards negative angles and of the other, is torque by
    moment arm, which in MIMo's model is the same all over the range of a joint: (LONGEST - SHORTEST) / range.
    """
    low, high = map(deg_to_rad, joint.range_deg)
    negative, positive = (
        PEAK * motor.gear_nm * abs(share) * (high - low) / (LONGEST - SHORTEST) for share in motor.force_range
    )
    return motor.vmax_lengths_per_s, negative, positive


def _antagonists(motor: Motor, joint: Joint) -> Iterator[Actuator]:
    low, high = map(deg_to_rad, joint.range_deg)
    negative, positive = motor.force_range
    yield _muscle(motor, "negative", 1.0, (low, high), abs(negative))
    yield _muscle(motor, "positive", -1.0, (-high, -low), positive)


def _muscle(motor: Motor, direction: str, gear: float, length_rad: tuple[float, float], share: float) -> Actuator:
    """Return a muscle that pulls a joint one way; *length_rad* is its length over the joint's range."""
    torque_nm = PEAK * motor.gear_nm * share
    curve = (
        *(SHORTEST, LONGEST, torque_nm, SCALE, LEAST_ACTIVE, MOST_ACTIVE),
        *(motor.vmax_lengths_per_s, PASSIVE_FORCE, LENGTHENING_FORCE),
    )
    return Actuator(
        name=f"{motor.name}_{direction}",
        mimo_actuator=motor.name,
        joint=motor.joint,
        gear=gear,
        control_range=(0.0, 1.0),
        settings=(("lengthrange", length_rad), ("gainprm", curve), ("biasprm", curve)),
    )

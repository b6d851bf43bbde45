"""Starting poses of an infant, resting on the ground."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mimoc.body import BodyTree, Joint
from mimoc.body.kinematics import pose
from mimoc.body.resting import rollers
from mimoc.body.stature import length_m
from mimoc.fits import measure
from mimoc.fits.tables import settled_deg
from mimoc.geometry.primitives import girth
from mimoc.geometry.rotations import Quaternion, quaternion_from_axis
from mimoc.schema.names import SIDES
from mimoc.units import deg_to_rad, rad_to_deg


@dataclass(frozen=True, slots=True)
class Pose:
    """Joint angles and orientation of the hip."""

    pitch_deg: float
    """Rotation of the hip about y: 90 is face down, -90 face up."""
    angles_deg: Mapping[str, float]
    """Angles by joint, without `robot:`; `{side}` stands for both sides."""
    on_feet: bool = False
    """Whether hips that do not straighten bend the knees, such that the soles are flat below the hips."""
    relaxed: bool = True
    """Whether joints without an angle are where their springs are slack; if not, they are straight."""
    held: tuple[str, ...] = ()
    """Joints, likewise, that strength holds: without it, an infant leaves this pose."""


_TRUNK = ("hip_*", "chest_*", "head_*")
_SEATED = {f"{{side}}_{joint}": angle for joint, angle in (("hip1", -102), ("hip2", -33), ("hip3", 0), ("knee", -25))}
"""A seat in which infants keep their balance, whatever they do with their hands."""
POSES: Mapping[str, Pose] = {
    "supine": Pose(-90, {"head_tilt": 0, "head_swivel": 0}),
    "prone": Pose(90, {}),
    "sitting": Pose(0, {**_SEATED, "hip_bend1": 8, "hip_bend2": 8}, held=(*_TRUNK, "{side}_hip*", "{side}_knee")),
    "standing": Pose(
        0,
        {f"{{side}}_{joint}": 0 for joint in ("hip1", "hip2", "hip3", "knee", "foot1", "foot2", "foot3")},
        on_feet=True,
        held=(*_TRUNK, "{side}_hip*", "{side}_knee", "{side}_foot*"),
    ),
}
"""What is the same at all ages in the poses of infants; `pose_of` adds the angles at which the rest of the body rests.
Joints that do not reach an angle at some age stop at the end of their range. Lumbar joints satisfy their couplings."""

FREE_DEG: Mapping[str, Mapping[str, float]] = {
    "supine": {"{side}_shoulder_ad_ab": 75.0},
    "sitting": {"{side}_shoulder_ad_ab": 75.0, "{side}_elbow": -90.0},
    "standing": {"{side}_shoulder_ad_ab": 50.0, "{side}_elbow": -60.0},
}
"""Angles at which arms are free of trunk and thighs, in poses in which they lie on them."""
FREED, ALIKE = 2.0, 0.01
"""Share of the way to these angles, for each unit by which a child differs in proportion from the average child, beyond
a difference that changes nothing. Fitted to P1 and P99 in length, weight and head, at 0, 6 and 24 months."""

PITCH = "pitch"
"""Rotation of the hip about y, among the angles of `data/postures.csv`."""
CHEST_JOINT = "robot:chest_lean"
"""One of the joints of bodies whose chest has some."""
CONTACT_DEPTH_M = 1e-4
"""Penetration depth of a resting body, such that the first physics step already supports its weight."""


def standing_height(tree: BodyTree) -> float:
    """Return the height of the hip above the soles when all joints are at zero, in [m]."""
    return pose(tree, {}).extent(np.array([0.0, 0.0, -1.0]))


def pose_of(tree: BodyTree, name: str) -> Pose:
    """Return the pose of `POSES` that a body takes, with the angles at which a body of its age comes to rest in it.

    Arms of a child of other proportions are lifted off, as they would begin inside its thighs or its trunk.
    """
    return _pose_of(tree, name, _disproportion(tree))


def poses_of(tree: BodyTree) -> list[Pose]:
    """Return all poses of `POSES`, in their order; see `pose_of`."""
    disproportion = _disproportion(tree)
    return [_pose_of(tree, name, disproportion) for name in POSES]


def _pose_of(tree: BodyTree, name: str, disproportion: float) -> Pose:
    wanted, settled = POSES[name], _settled_deg(tree, name)
    pitch_deg = settled.pop(PITCH, wanted.pitch_deg)
    share = FREED * max(0.0, disproportion - ALIKE)
    for joint, free_deg in FREE_DEG.get(name, {}).items():
        if share and joint in settled:
            settled[joint] += min(1.0, share) * (free_deg - settled[joint])
    return replace(wanted, pitch_deg=pitch_deg, angles_deg={**settled, **wanted.angles_deg})


def _settled_deg(tree: BodyTree, name: str) -> dict[str, float]:
    hands = tree.hands if tree.hands == "five_finger" else "mitten"  # Others' hands were not laid down.
    return settled_deg(tree.development, hands, CHEST_JOINT in tree.joints, name, tree.age_months)


def _disproportion(tree: BodyTree) -> float:
    """Return how much thicker or thinner the thighs of a body are for its length than the average child's of its age.

    That is the difference of two ratios to the average child: of the girth of a thigh, and of the length of the body.
    """
    average_m = measure(tree.age_months)
    thighs = [tree.geoms[name] for name in ("left_upper_leg1", "right_upper_leg1") if name in tree.geoms]
    if not thighs:
        return 0.0
    girth_ratio = girth(thighs[0].type, thighs[0].size_m) / average_m["mid_thigh_circumference"]
    return abs(girth_ratio - length_m(tree) / average_m["crown_sole_length"])


def pose_angles(tree: BodyTree, wanted: Pose) -> dict[str, float]:
    """Return the angle of each hinge of *tree* in a pose, in [rad], within its range."""
    return _angles(tree, wanted, tree.joints)


def _angles(tree: BodyTree, wanted: Pose, joints: Mapping[str, Joint]) -> dict[str, float]:
    """Return `pose_angles` of a body with these joints."""
    named_deg = {
        "robot:" + name.format(side=side): angle for name, angle in wanted.angles_deg.items() for side in SIDES
    }
    angles = {
        name: deg_to_rad(clip(joint, named_deg.get(name, joint.springref_deg if wanted.relaxed else 0.0)))
        for name, joint in joints.items()
    }
    if wanted.on_feet:
        for side in SIDES:
            angles |= _on_foot(tree, side, angles)
    return angles


def clip(joint: Joint, angle_deg: float) -> float:
    """Return the angle within a joint's range that is nearest to the given one, in degrees."""
    low, high = joint.range_deg
    return min(max(angle_deg, low), high)


def _on_foot(tree: BodyTree, side: str, angles: Mapping[str, float]) -> dict[str, float]:
    """Return the angles of knee and ankle of a leg whose hip may not straighten, in [rad].

    The knee is bent so that the ankle is below the hip, and the ankle such that the sole is parallel to the ground.
    """
    hip, knee, ankle = (f"robot:{side}_{joint}" for joint in ("hip1", "knee", "foot1"))
    bodies = {body.name: body for body in tree.bodies}
    if not {hip, knee, ankle} <= set(angles):
        return {}
    thigh_m, shank_m = (math.dist(bodies[f"{side}_{end}"].pos_m, (0, 0, 0)) for end in ("lower_leg", "foot"))
    forward = -angles[hip]
    bent = forward + math.asin(max(-1.0, min(1.0, thigh_m / shank_m * math.sin(forward))))
    return {
        knee: deg_to_rad(clip(tree.joints[knee], -rad_to_deg(bent))),
        ankle: deg_to_rad(clip(tree.joints[ankle], rad_to_deg(bent - forward))),
    }


def resting_state(tree: BodyTree, wanted: Pose) -> tuple[float, ...]:
    """Return a pose at rest on the ground as qpos: position and quaternion of the hip, then the hinges."""
    (state,) = resting_states(tree, [wanted])
    return state


def resting_states(tree: BodyTree, wanted: Sequence[Pose]) -> list[tuple[float, ...]]:
    """Return some poses at rest on the ground as qpos; see `resting_state`.

    The body, as if it were rigid, rolls about y to the nearest minimum of the height of its centre of mass.

    Args:
        tree: The body.
        wanted: The poses; the minimum is the one that is reached downhill from the pitch of each.
    """
    joints = tree.joints
    poses_rad = [_angles(tree, each, joints) for each in wanted]
    found = rollers(tree, poses_rad).rest(np.array([deg_to_rad(each.pitch_deg) for each in wanted]))
    return [
        (0.0, 0.0, height_m - CONTACT_DEPTH_M, *pitched(pitch_rad), *angles.values())
        for angles, (pitch_rad, height_m) in zip(poses_rad, found, strict=True)
    ]


def pitched(pitch_rad: float) -> Quaternion:
    """Return the rotation of a hip about y as a quaternion."""
    return quaternion_from_axis((0.0, 1.0, 0.0), pitch_rad)

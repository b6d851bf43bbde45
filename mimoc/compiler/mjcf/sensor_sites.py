"""The sites, cameras and MuJoCo sensors that every body has for its senses, and the 25 keypoints of BODY_25."""

import math
from collections.abc import Iterator
from typing import NamedTuple

from mimoc.anatomy.published_figures import SIZES_M
from mimoc.anatomy.sections import BUTTOCKS, RUMP
from mimoc.base.geometry.rotations import Vec3
from mimoc.body.tree import BodyTree, as_on_mimos_head
from mimoc.compiler.mjcf.elements import Camera, Sensor, Site

SITE_RADIUS_M = 0.01
FINGER_SITE_RADIUS_M = 0.002  # Only for display; the second in hands with five fingers (MIMo).

UNSEEN = ("head", "left_eye", "right_eye")  # Bodies that an infant's own eyes do not see.

FOVY_DEG = 60.0  # Vertical field of view of an eye, unless a spec gives another (MIMo).

CENTRE_SITE = "lowerBody_center"
VESTIBULAR_SITE = "vestibular"

VESTIBULAR_SENSORS = (
    Sensor("accelerometer", "vestibular_acc", VESTIBULAR_SITE),
    Sensor("gyro", "vestibular_gyro", VESTIBULAR_SITE),
)

_OTHER_NAMES = {"torque_ub": "trunk_upper", "torque_lb": "trunk_lower"}
"""Sensors whose name differs from their site's, by site."""
_FINGERS = (
    *(f"{finger}{bone}" for finger in ("ff", "mf", "rf") for bone in ("knuckle", "middle", "distal")),
    *("lfmetacarpal", "lfknuckle", "lfmiddle", "lfdistal", "thbase", "thhub", "thdistal"),
)
_ARM = ("upper_arm", "lower_arm", "hand", "fingers", *_FINGERS)
_LEG = ("upper_leg", "lower_leg", "foot", "toes", "big_toe")
_IN_ORDER_OF_SENSORS = (
    *("head", "left_eye", "right_eye", "upper_body", "lower_body"),
    *(f"{side}_{body}" for limb in (_ARM, _LEG) for side in ("right", "left") for body in limb),
    "chest",
)
"""MIMo's bodies; any others come after them."""


def torque_sensors(tree: BodyTree) -> tuple[Sensor, ...]:
    """Return MIMo's three-axis torque sensors, in MIMo's order, for the bodies that this infant has."""
    places = {body.name: body.torque_site for body in tree.bodies if body.torque_site}
    known = [name for name in _IN_ORDER_OF_SENSORS if name in places]
    in_order = (places[name] for name in dict.fromkeys((*known, *places)))
    names = ((_OTHER_NAMES.get(place, place.removeprefix("torque_")), place) for place in in_order)
    return tuple(Sensor("torque", f"proprio:{name}", place) for name, place in names)


def sites(tree: BodyTree) -> dict[str, tuple[Site, ...]]:
    """Return the sites of each body."""
    centre = {"hip": (Site(CENTRE_SITE, (0.0, 0.0, 0.0), SITE_RADIUS_M),)}
    fine = {f"{side}_{finger}" for side in ("right", "left") for finger in _FINGERS}
    fine |= {"right_hand", "left_hand"} if tree.hands == "five_finger" else set()
    torque = {
        body.name: (
            Site(body.torque_site, (0.0, 0.0, 0.0), FINGER_SITE_RADIUS_M if body.name in fine else SITE_RADIUS_M),
        )
        for body in tree.bodies
        if body.torque_site
    }
    vestibular = {"head": (Site(VESTIBULAR_SITE, tree.geoms["head"].pos_m, SITE_RADIUS_M), *torque["head"])}
    return centre | torque | vestibular


def cameras(tree: BodyTree, fovy_deg: float = FOVY_DEG) -> dict[str, tuple[Camera, ...]]:
    """Return the camera of each eye, looking along +x, up along +z.

    It is on the front of the eyeball; by the published law where it is at 18 months (`published_figures.DEFECTS`).
    """
    euler_rad = (math.radians(90), math.radians(-90), 0.0)
    geoms = tree.geoms
    cameras: dict[str, tuple[Camera, ...]] = {}
    for side in ("left", "right"):
        if eye := geoms.get(f"{side}_eye1"):
            (front_m,) = SIZES_M["{side}_eye1"] if tree.development == "published" else eye.size_m
            cameras[f"{side}_eye"] = (Camera(f"eye_{side}", (front_m, 0.0, 0.0), euler_rad, fovy_deg),)
    return cameras


PREFIX = "BODY_25:"
KEYPOINTS = (
    *("Nose", "Neck", "RShoulder", "RElbow", "RWrist", "LShoulder", "LElbow", "LWrist"),
    *("MidHip", "RHip", "RKnee", "RAnkle", "LHip", "LKnee", "LAnkle", "REye", "LEye", "REar", "LEar"),
    *("LBigToe", "LSmallToe", "LHeel", "RBigToe", "RSmallToe", "RHeel"),
)
"""In BODY_25's order (OpenPose)."""

ORIGINS = {
    "Shoulder": "upper_arm",
    "Elbow": "lower_arm",
    "Wrist": "hand",
    "Hip": "upper_leg",
    "Knee": "lower_leg",
    "Eye": "eye",
}
"""Keypoints at the origin of a body, for each side."""

RADIUS_M = 0.005  # Only for looking at.


def keypoint_sites(tree: BodyTree) -> dict[str, list[Site]]:
    """Return the keypoints of each body; those of limbs that this infant does not have are left out."""
    bodies = {body.name for body in tree.bodies}
    sites: dict[str, list[Site]] = {}
    for name, body, pos_m in (*_middle(tree), *_sides(tree)):
        if body in bodies:
            sites.setdefault(body, []).append(Site(PREFIX + name, pos_m, RADIUS_M))
    return sites


# Keypoints on the head of MIMo v2, in its frame.
NOSE_M, RIGHT_EAR_M, LEFT_EAR_M = (0.0685, 0.0, 0.0435), (0.01, -0.0625, 0.0575), (0.01, 0.0625, 0.0575)


def _middle(tree: BodyTree) -> Iterator[tuple[str, str, Vec3]]:
    """Yield the keypoints of head and hip; those of the head are in proportion to it."""
    head = tree.geoms["head"]
    yield "Nose", "head", as_on_mimos_head(head, NOSE_M)
    yield "Neck", "head", (0.0, 0.0, 0.0)
    yield "REar", "head", as_on_mimos_head(head, RIGHT_EAR_M)
    yield "LEar", "head", as_on_mimos_head(head, LEFT_EAR_M)
    yield "MidHip", "hip", _between_hip_joints(tree)


def _between_hip_joints(tree: BodyTree) -> Vec3:
    """Return the middle of the hip joints; if one leg is absent, its joint mirrors the other one.

    Without legs, it is where the average child's is in its pelvis.
    """
    joints_m = [body.pos_m for body in tree.bodies if body.name in ("left_upper_leg", "right_upper_leg")]
    if joints_m:
        x_m, _, z_m = (math.fsum(along) / len(joints_m) for along in zip(*joints_m, strict=True))
        return x_m, 0.0, z_m
    pelvis = tree.geoms["lb"]
    (radius_m, _), (x_m, _, z_m) = pelvis.size_m, pelvis.pos_m
    return x_m - (1 - BUTTOCKS) * radius_m, 0.0, z_m - (1 - RUMP) * radius_m


def _sides(tree: BodyTree) -> Iterator[tuple[str, str, Vec3]]:
    for side, letter, outward in (("right", "R", -1.0), ("left", "L", 1.0)):
        for name, body in ORIGINS.items():
            yield letter + name, f"{side}_{body}", (0.0, 0.0, 0.0)
        if f"{side}_foot" in {body.name for body in tree.bodies}:
            yield from _foot(tree, side, letter, outward)


class FootPoint(NamedTuple):
    """A keypoint of a foot, in the frame of the part that it is on, on MIMo's feet at 18 months."""

    part: str
    ahead_m: float  # Along the foot.
    outward_m: float  # Across it, away from the other foot.


HEEL = FootPoint("foot", -0.020, 0.0)
TOES_IN_ONE_PIECE = {"BigToe": FootPoint("toes", 0.011, -0.012), "SmallToe": FootPoint("toes", 0.010, 0.012)}
SEPARATE_TOES = {"BigToe": FootPoint("big_toe", 0.011, 0.0), "SmallToe": FootPoint("toes", 0.010, 0.0045)}
# Half lengths and the half width of the soles that these were measured on.
SOLE_HALF_LENGTHS_M = {"one_piece": 0.035, "separate_toes": 0.030}
SOLE_HALF_WIDTH_M = 0.025


def _foot(tree: BodyTree, side: str, letter: str, outward: float) -> Iterator[tuple[str, str, Vec3]]:
    """Yield ankle, heel and toes; the toes' points are on the toes, so that they move with them."""
    separate_toes = tree.hands == "five_finger"
    sole = "separate_toes" if separate_toes and tree.development == "maturing" else "one_piece"
    half_length_m, half_width_m, *_ = tree.geoms[f"{side}_foot2"].size_m
    long = half_length_m / SOLE_HALF_LENGTHS_M[sole]
    wide = half_width_m / SOLE_HALF_WIDTH_M
    yield letter + "Ankle", f"{side}_foot", tree.joints[f"robot:{side}_foot3"].anchor_m
    for name, point in {"Heel": HEEL, **(SEPARATE_TOES if separate_toes else TOES_IN_ONE_PIECE)}.items():
        pos_m = (point.ahead_m * long, outward * point.outward_m * wide, 0.0)
        yield letter + name, f"{side}_{point.part}", pos_m

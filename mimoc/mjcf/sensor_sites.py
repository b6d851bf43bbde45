"""The sites, cameras and MuJoCo sensors that every body has for its senses."""

from mimoc.body import BodyTree
from mimoc.mjcf.infant import Camera, Sensor, Site
from mimoc.units import deg_to_rad

SITE_RADIUS_M = 0.01
FINGER_SITE_RADIUS_M = 0.002
"""Only for display; the second in hands with five fingers (MIMo)."""

UNSEEN = ("head", "left_eye", "right_eye")
"""Bodies that an infant's own eyes do not see."""

FOVY_DEG = 60.0
"""Vertical field of view of an eye, unless a spec gives another (MIMo)."""

CENTRE_SITE = "lowerBody_center"
VESTIBULAR_SITE = "vestibular"

TORQUE_SITES = {
    "lower_body": "torque_lb",
    "upper_body": "torque_ub",
    "chest": "torque_chest",
    "head": "torque_neck",
    "{side}_eye": "torque_{side}_eye",
    "{side}_upper_arm": "torque_{side}_shoulder",
    "{side}_lower_arm": "torque_{side}_elbow",
    "{side}_hand": "torque_{side}_wrist",
    "{side}_fingers": "torque_{side}_fingers",
    "{side}_upper_leg": "torque_{side}_hip",
    "{side}_lower_leg": "torque_{side}_knee",
    "{side}_foot": "torque_{side}_ankle",
    "{side}_toes": "torque_{side}_toes",
    "{side}_big_toe": "torque_{side}_big_toe",
    **{
        f"{{side}}_{finger}{bone}": f"torque_{{side}}_{finger}_{bone}"
        for finger in ("ff", "mf", "rf", "lf")
        for bone in ("knuckle", "middle", "distal")
    },
    "{side}_lfmetacarpal": "torque_{side}_lf_meta",
    "{side}_thbase": "torque_{side}_th_base",
    "{side}_thhub": "torque_{side}_th_hub",
    "{side}_thdistal": "torque_{side}_th_distal",
}
"""MIMo's names of the sites that measure the torque between a body and its parent, by body."""

VESTIBULAR_SENSORS = (
    Sensor("accelerometer", "vestibular_acc", VESTIBULAR_SITE),
    Sensor("gyro", "vestibular_gyro", VESTIBULAR_SITE),
)

_TRUNK_AND_HEAD = {
    "neck": "head",
    "left_eye": "left_eye",
    "right_eye": "right_eye",
    "trunk_upper": "upper_body",
    "trunk_lower": "lower_body",
}
_ARM = ("upper_arm", "lower_arm", "hand", "fingers")
_FINGERS = (
    *(f"{finger}{bone}" for finger in ("ff", "mf", "rf") for bone in ("knuckle", "middle", "distal")),
    *("lfmetacarpal", "lfknuckle", "lfmiddle", "lfdistal", "thbase", "thhub", "thdistal"),
)
_LEG = ("upper_leg", "lower_leg", "foot", "toes", "big_toe")
_LIMBS = tuple(f"{side}_{body}" for limb in ((*_ARM, *_FINGERS), _LEG) for side in ("right", "left") for body in limb)


def torque_sensors(tree: BodyTree) -> tuple[Sensor, ...]:
    """Return MIMo's three-axis torque sensors, in MIMo's order, for the bodies that this infant has."""
    site = _both_sides(TORQUE_SITES)
    names = {
        **{name: site[body] for name, body in _TRUNK_AND_HEAD.items()},
        **{site[body].removeprefix("torque_"): site[body] for body in (*_LIMBS, "chest")},
    }
    here = {site[body.name] for body in tree.bodies if body.name in site}
    return tuple(Sensor("torque", f"proprio:{name}", place) for name, place in names.items() if place in here)


def sites(tree: BodyTree) -> dict[str, tuple[Site, ...]]:
    """Return the sites of each body."""
    centre = {"hip": (Site(CENTRE_SITE, (0.0, 0.0, 0.0), SITE_RADIUS_M),)}
    fine = {f"{side}_{finger}" for side in ("right", "left") for finger in _FINGERS}
    fine |= {"right_hand", "left_hand"} if tree.hands == "five_finger" else set()
    torque = {
        body: (Site(name, (0.0, 0.0, 0.0), FINGER_SITE_RADIUS_M if body in fine else SITE_RADIUS_M),)
        for body, name in _both_sides(TORQUE_SITES).items()
    }
    vestibular = {"head": (Site(VESTIBULAR_SITE, tree.geoms["head"].pos_m, SITE_RADIUS_M), *torque["head"])}
    return centre | torque | vestibular


def cameras(tree: BodyTree, fovy_deg: float = FOVY_DEG) -> dict[str, tuple[Camera, ...]]:
    """Return the camera of each eye: on the front of the eyeball, looking along +x, up along +z."""
    euler_rad = (deg_to_rad(90), deg_to_rad(-90), 0.0)
    return {
        f"{side}_eye": (Camera(f"eye_{side}", (tree.geoms[f"{side}_eye1"].size_m[0], 0.0, 0.0), euler_rad, fovy_deg),)
        for side in ("left", "right")
        if f"{side}_eye" in {body.name for body in tree.bodies}
    }


def _both_sides(names: dict[str, str]) -> dict[str, str]:
    return {
        body.format(side=side): site.format(side=side) for body, site in names.items() for side in ("right", "left")
    }

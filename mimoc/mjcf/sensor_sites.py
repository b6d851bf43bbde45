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

VESTIBULAR_SENSORS = (
    Sensor("accelerometer", "vestibular_acc", VESTIBULAR_SITE),
    Sensor("gyro", "vestibular_gyro", VESTIBULAR_SITE),
)

_OTHER_NAMES = {"torque_ub": "trunk_upper", "torque_lb": "trunk_lower"}
"""Of sensors that are not named as their sites are."""
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
    return tuple(Sensor("torque", f"proprio:{_sensor_name(place)}", place) for place in in_order)


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
    """Return the camera of each eye: on the front of the eyeball, looking along +x, up along +z."""
    euler_rad = (deg_to_rad(90), deg_to_rad(-90), 0.0)
    return {
        f"{side}_eye": (Camera(f"eye_{side}", (tree.geoms[f"{side}_eye1"].size_m[0], 0.0, 0.0), euler_rad, fovy_deg),)
        for side in ("left", "right")
        if f"{side}_eye" in {body.name for body in tree.bodies}
    }


def _sensor_name(site: str) -> str:
    return _OTHER_NAMES.get(site, site.removeprefix("torque_"))

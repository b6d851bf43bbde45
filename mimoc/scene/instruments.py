"""Where an infant's senses sit: the sites, cameras and MuJoCo sensors of its body."""

from mimoc.body import BodyTree
from mimoc.scene.tree import Camera, Sensor, Site
from mimoc.units import deg_to_rad

SITE_RADIUS_M = 0.01
"""Only for looking at."""

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
}
"""MIMo's names for the sites that feel the torque between a body and its parent, by body."""

VESTIBULAR_SENSORS = (
    Sensor("accelerometer", "vestibular_acc", VESTIBULAR_SITE),
    Sensor("gyro", "vestibular_gyro", VESTIBULAR_SITE),
)

_TRUNK_AND_HEAD = ("neck", "left_eye", "right_eye", "trunk_upper", "trunk_lower")
_ARM = ("shoulder", "elbow", "wrist", "fingers")
_LEG = ("hip", "knee", "ankle", "toes")
_LIMBS = tuple(f"{side}_{joint}" for limb in (_ARM, _LEG) for side in ("right", "left") for joint in limb)

TORQUE_SENSORS = tuple(
    Sensor(
        "torque",
        f"proprio:{where}",
        {"trunk_upper": "torque_ub", "trunk_lower": "torque_lb"}.get(where, f"torque_{where}"),
    )
    for where in (*_TRUNK_AND_HEAD, *_LIMBS, "chest")
)
"""MIMo's three-axis torque sensors, in MIMo's order."""


def sites(tree: BodyTree) -> dict[str, tuple[Site, ...]]:
    """Return the sites of each body."""
    centre = {"hip": (Site(CENTRE_SITE, (0.0, 0.0, 0.0), SITE_RADIUS_M),)}
    torque = {body: (Site(name, (0.0, 0.0, 0.0), SITE_RADIUS_M),) for body, name in _both_sides(TORQUE_SITES).items()}
    balance = {"head": (Site(VESTIBULAR_SITE, tree.geoms["head"].pos_m, SITE_RADIUS_M), *torque["head"])}
    return centre | torque | balance


def cameras(tree: BodyTree, fovy_deg: float) -> dict[str, tuple[Camera, ...]]:
    """Return the camera of each eye: on the front of the eyeball, looking along +x, up along +z."""
    euler_rad = (deg_to_rad(90), deg_to_rad(-90), 0.0)
    return {
        f"{side}_eye": (
            Camera(f"eye_{side}", (tree.geoms[f"geom:{side}_eye1"].size_m[0], 0.0, 0.0), euler_rad, fovy_deg),
        )
        for side in ("left", "right")
    }


def _both_sides(names: dict[str, str]) -> dict[str, str]:
    return {
        body.format(side=side): site.format(side=side) for body, site in names.items() for side in ("right", "left")
    }

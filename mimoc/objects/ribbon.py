"""The ribbon from an object to a wrist or an ankle of the infant."""

import numpy as np

from mimoc.base.errors import ObjectError
from mimoc.geometry.rotations import matrix_from_quaternion
from mimoc.mjcf.sensor_sites import PREFIX, keypoint_sites
from mimoc.mjcf.world import ObjectBody, Ribbon
from mimoc.objects.built_object import Surroundings, Tie

KEYPOINTS = {"foot": "Ankle", "hand": "Wrist"}
"""Where a ribbon is tied, by what the name of the limb ends with."""


def tie_ribbon(tie: Tie, root: ObjectBody, around: Surroundings) -> Ribbon:
    """Return the ribbon of an object whose outermost body is in the world.

    Raises:
        ObjectError: If the infant has no such limb.
    """
    side, _, limb = tie.limb.partition("_")
    name = f"{PREFIX}{side[0].upper()}{KEYPOINTS[limb]}"
    places = {site.name: (body, site) for body, sites in keypoint_sites(around.tree).items() for site in sites}
    if name not in places:
        raise ObjectError("tied_to", f"this infant has no {tie.limb}; tie it to another limb, or leave this out")
    body, site = places[name]
    origin, turn = around.frames[body]
    (start,) = (mine for mine in root.sites if mine.name == tie.site)
    start_m = matrix_from_quaternion(root.quat) @ start.pos_m + root.pos_m
    way_m = float(np.linalg.norm(origin + turn @ site.pos_m - start_m))
    return Ribbon(f"{root.name}_ribbon", (tie.site, around.prefix + name), (0.0, way_m + tie.slack_m), tie.rgba)

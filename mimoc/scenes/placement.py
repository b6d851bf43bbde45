"""The infant and what belongs to it, placed elsewhere on the floor."""

from dataclasses import replace

import numpy as np

from mimoc.body.kinematics import FloatArray
from mimoc.geometry.rotations import matrix_from_axis, quaternion_from_axis, quaternion_product
from mimoc.mjcf.objects import FreeObject
from mimoc.mjcf.scene import Keyframe
from mimoc.scenes.built_scene import Placement

UP = (0.0, 0.0, 1.0)


def place_pose(pose: Keyframe, start: Placement) -> Keyframe:
    """Return a pose elsewhere on the floor, turned about the vertical."""
    x, y, z, *turn = pose.qpos[:7]
    ((x, y, z),) = place_discs(np.array([(x, y, z)]), start).tolist()
    w, i, j, k = turn
    turned = quaternion_product(quaternion_from_axis(UP, start.yaw_rad), (w, i, j, k))
    return Keyframe(pose.name, (x, y, z, *turned, *pose.qpos[7:]), pose.settings)


def place_object(thing: FreeObject, start: Placement) -> FreeObject:
    """Return an object elsewhere on the floor; it is not turned, for it looks the same from all sides."""
    (x, y, _), z = place_discs(np.array([thing.pos_m]), start)[0].tolist(), thing.pos_m[2]
    return replace(thing, pos_m=(x, y, z))


def place_discs(discs: FloatArray, start: Placement) -> FloatArray:
    """Return discs elsewhere on the floor, turned about the vertical with what is at the origin."""
    places = discs[:, :2] @ matrix_from_axis(UP, start.yaw_rad)[:2, :2].T + (start.x_m, start.y_m)
    return np.column_stack([places, discs[:, 2]])

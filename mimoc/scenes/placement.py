"""The infant and what belongs to it, put somewhere else on the floor."""

from dataclasses import replace

import numpy as np

from mimoc.body.kinematics import FloatArray
from mimoc.geometry.rotations import matrix_from_axis, quaternion_from_axis, quaternion_product
from mimoc.mjcf.tree import Keyframe, Prop
from mimoc.scenes.setting import Placement

UP = (0.0, 0.0, 1.0)


def put(pose: Keyframe, start: Placement) -> Keyframe:
    """Return a pose somewhere else on the floor, turned about the vertical."""
    x, y, z, *turn = pose.qpos[:7]
    ((x, y, z),) = moved(np.array([(x, y, z)]), start).tolist()
    w, i, j, k = turn
    turned = quaternion_product(quaternion_from_axis(UP, start.yaw_rad), (w, i, j, k))
    return Keyframe(pose.name, (x, y, z, *turned, *pose.qpos[7:]), pose.settings)


def put_prop(prop: Prop, start: Placement) -> Prop:
    """Return a prop somewhere else on the floor; it is a ball, or looks the same from all sides."""
    (x, y, _), z = moved(np.array([prop.pos_m]), start)[0].tolist(), prop.pos_m[2]
    return replace(prop, pos_m=(x, y, z))


def moved(discs: FloatArray, start: Placement) -> FloatArray:
    """Return discs somewhere else on the floor, turned about the vertical with what is at the origin."""
    places = discs[:, :2] @ matrix_from_axis(UP, start.yaw_rad)[:2, :2].T + (start.x_m, start.y_m)
    return np.column_stack([places, discs[:, 2]])

"""The infant and what belongs to it, placed elsewhere on the floor."""

import math
from dataclasses import replace

import numpy as np

from mimoc.body.kinematics import FloatArray
from mimoc.mjcf.objects import FreeObject
from mimoc.mjcf.scene import Keyframe
from mimoc.scenes.built_scene import Placement


def place_pose(pose: Keyframe, start: Placement) -> Keyframe:
    """Return a pose elsewhere on the floor, turned about the vertical."""
    x, y, z, w, i, j, k = pose.qpos[:7]
    cos, sin = math.cos(start.yaw_rad), math.sin(start.yaw_rad)
    half_cos, half_sin = math.cos(start.yaw_rad / 2), math.sin(start.yaw_rad / 2)
    place = (start.x_m + cos * x - sin * y, start.y_m + sin * x + cos * y, z)
    turn = (
        half_cos * w - half_sin * k,
        half_cos * i - half_sin * j,
        half_cos * j + half_sin * i,
        half_cos * k + half_sin * w,
    )
    return Keyframe(pose.name, (*place, *turn, *pose.qpos[7:]), pose.settings)


def place_object(thing: FreeObject, start: Placement) -> FreeObject:
    """Return an object elsewhere on the floor; it is not turned, for it looks the same from all sides."""
    (x, y, _), z = place_discs(np.array([thing.pos_m]), start)[0].tolist(), thing.pos_m[2]
    return replace(thing, pos_m=(x, y, z))


def place_discs(discs: FloatArray, start: Placement) -> FloatArray:
    """Return discs elsewhere on the floor, turned about the vertical with what is at the origin."""
    cos, sin = math.cos(start.yaw_rad), math.sin(start.yaw_rad)
    places = discs[:, :2] @ np.array([[cos, sin], [-sin, cos]]) + (start.x_m, start.y_m)
    return np.column_stack([places, discs[:, 2]])

"""How somebody leans: a caregiver over an infant, and an infant to what it reaches."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from mimoc.base.geometry.rotations import FloatArray

Frame = tuple[FloatArray, FloatArray]
"""Origin, shape (3,), [m], and rotation, shape (3, 3): x forwards, y to the left, z towards the crown."""
Where = Literal["in_front", "beside", "above"]

UP = np.array([0.0, 0.0, 1.0])
LEVEL = 0.35  # Level part of a direction below which it counts as vertical: 70 degrees of elevation.
FLOOR_M = 0.02  # Gap between a head and the floor at least.
MIN_DISTANCE_M = 0.2  # Distance of two faces at least.
UPRIGHT_RAD, BENT_RAD = math.radians(15), math.radians(70)
"""Lean of a trunk that looks straight ahead, and how much more it leans that looks straight down; assumptions."""


@dataclass(frozen=True, slots=True)
class Figure:
    """Lengths of somebody, in [m]."""

    face_m: float  # From the centre of the head forwards to the face.
    crown_m: float  # From the centre of the head up to the crown.
    neck_m: tuple[float, float]  # From the centre of the head to the neck's base: backwards, and down.
    trunk_m: float  # From the neck's base to the hips.
    hip_m: float  # Radius of the trunk at the hips.


@dataclass(frozen=True, slots=True)
class Leaning:
    """Where head and trunk are."""

    head: Frame  # Frame of the centre of the head.
    trunk: Frame  # Frame of the trunk at the base of the neck.


def leaning_pose(
    figure: Figure, face: Frame, where: Where, to_left: bool, distance_m: float, height_m: float | None
) -> Leaning:
    """Return the head and trunk of somebody who looks at another face from a given side and distance.

    Args:
        figure: Lengths of the one who looks.
        face: The face that is looked at: a point between the eyes, and the head's axes.
        where: `in_front` is where that face looks to, or, if it looks down, before its crown; `beside` is level, to its
            left or right; `above` is over it.
        to_left: Whether beside is to the left.
        distance_m: Between both faces.
        height_m: Height of the own face above the floor, z = 0; None for the one that *where* and *distance_m* give.
    """
    seen_m, seen_axes = face
    to_side = _level(seen_axes[:, 1], seen_axes[:, 0]) * (1.0 if to_left else -1.0)
    # Who lies face down has the world overhead.
    ahead = seen_axes[:, 0] if seen_axes[2, 0] > -LEVEL else _level(seen_axes[:, 2])
    offset_direction = {"in_front": ahead, "beside": to_side, "above": UP}[where]
    face_m = seen_m + distance_m * offset_direction
    face_m[2] = max(face_m[2] if height_m is None else height_m, figure.crown_m + FLOOR_M)
    if np.linalg.norm(face_m - seen_m) < MIN_DISTANCE_M:
        face_m = seen_m + MIN_DISTANCE_M * UP
    gaze: FloatArray = (seen_m - face_m) / np.linalg.norm(seen_m - face_m)
    level = _level(gaze, seen_axes[:, 2], -seen_axes[:, 0])
    down_rad = math.asin(min(max(-gaze[2], 0.0), 1.0))
    head = _head_axes(gaze, level, down_rad)
    centre_m = face_m - figure.face_m * gaze
    neck_m = centre_m - figure.neck_m[0] * gaze - figure.neck_m[1] * head[:, 2]
    return Leaning((centre_m, head), (neck_m, _trunk_axes(figure, neck_m[2], level, down_rad)))


def _head_axes(gaze: FloatArray, level: FloatArray, down_rad: float) -> FloatArray:
    """Return the axes of a head that looks along *gaze*, down by an angle, shape (3, 3); *level* is where it faces."""
    direction = math.sin(down_rad) * level + math.cos(down_rad) * UP
    head_up_raw = direction - (direction @ gaze) * gaze
    head_up = head_up_raw / np.linalg.norm(head_up_raw)
    return np.column_stack([gaze, np.cross(head_up, gaze), head_up])


def _trunk_axes(figure: Figure, neck_height_m: float, level: FloatArray, down_rad: float) -> FloatArray:
    """Return the axes of a trunk that leans the more, the more its head looks down, and at least to the neck's height.

    Who sits on the floor leans so far that the face is as low as asked.
    """
    lean_rad = UPRIGHT_RAD + BENT_RAD * down_rad / (math.pi / 2)
    # Height of the neck above hips on the floor, in lengths of the trunk.
    neck_share = min(max((neck_height_m - figure.hip_m) / figure.trunk_m, 0.0), 1.0)
    lean_rad = max(lean_rad, math.acos(neck_share))
    spine = math.sin(lean_rad) * level + math.cos(lean_rad) * UP
    forward = math.cos(lean_rad) * level - math.sin(lean_rad) * UP
    return np.column_stack([forward, np.cross(spine, forward), spine])


def _level(*directions: FloatArray) -> FloatArray:
    """Return the level part of the first direction that has enough of it, as a unit vector, shape (3,)."""
    for direction in directions:
        flat = np.array([direction[0], direction[1], 0.0])
        if np.linalg.norm(flat) > LEVEL:
            return flat / np.linalg.norm(flat)
    return np.array([1.0, 0.0, 0.0])


LEAN_DEG = 60.0  # How far a sitting infant leans over to reach something.
STRETCHED = 0.6  # How far from the shoulder an object is in the air within reach, in lengths of the arm.


def leaning_reach(arm_m: float, shoulder_m: float, hip_m: float) -> float:
    """Return how far from its hip, seen from above, an infant reaches the floor: it leans over, or else crouches."""
    lean_rad = np.radians(np.linspace(0.0, LEAN_DEG, 16))
    ahead_m = (shoulder_m - hip_m) * np.sin(lean_rad)
    height_m = hip_m + (shoulder_m - hip_m) * np.cos(lean_rad)
    reaches_floor = height_m < arm_m
    if not reaches_floor.any():
        return arm_m
    return float((ahead_m + np.sqrt(np.maximum(arm_m**2 - height_m**2, 0.0)))[reaches_floor].max())


def places_around(ahead_rad: float, farthest_m: float, step_m: float, directions: int) -> Iterator[tuple[float, float]]:
    """Yield places around the origin, x and y in [m], the nearest first, and of those the ones ahead first."""
    yield 0.0, 0.0
    turns = [ahead_rad + (-1) ** turn * ((turn + 1) // 2) * math.tau / directions for turn in range(directions)]
    for away_m in np.arange(step_m, farthest_m, step_m):
        yield from ((away_m * math.cos(turn), away_m * math.sin(turn)) for turn in turns)

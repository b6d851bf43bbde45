"""A hand that closes around a bar, and the arm that brings it there."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from mimoc.base.errors import UnsupportedTaskError
from mimoc.base.geometry.rotations import Vec3
from mimoc.base.units import deg_to_rad
from mimoc.body.kinematics import FloatArray, frames
from mimoc.body.tree import BodyTree
from mimoc.compiler.task_setup import Side

CLEAR_M = 0.001
"""Between a bar and the hand around it: the hold carries the infant, not the contact."""
KNUCKLES_DEG = 60.0
"""How far the fingers are bent at the knuckles."""
CURLED_DEG: Mapping[str, Mapping[str, float]] = {
    "mitten": {"fingers": -KNUCKLES_DEG},
    "five_finger": {
        **{f"{finger}_knuckle": KNUCKLES_DEG for finger in ("ff", "mf", "rf")},
        **{f"{finger}_middle": 30.0 for finger in ("ff", "mf", "rf", "lf")},
        **{f"{finger}_distal": 15.0 for finger in ("ff", "mf", "rf", "lf")},
        "lf_knuckle": 50.0,  # It begins nearer to the wrist.
        "th_swivel": -8.0,
    },
}
"""Fingers around a bar, by kind of hand and joint; a thumb stays beside the palm."""
KNUCKLES = {"mitten": "fingers", "five_finger": "mfknuckle"}
"""The first body of the fingers."""
STRETCHED_OUT_DEG: Mapping[str, float] = {
    "shoulder_horizontal": 80,
    "shoulder_ad_ab": 90,
    "shoulder_rotation": 0,
    "elbow": -30,
    "hand1": 0,
    "hand2": 0,
    "hand3": 0,
}
"""An arm that is stretched out forwards, as it would rather be: there the search for its angles begins."""
ROUNDS = 40
SHYNESS, FADING, LEAST_SHYNESS = 0.1, 0.6, 1e-4
"""How much a radian away from there counts against a metre at first, what is left of that after each round, and at
last."""
TURN_M = 0.1
"""What a hand that is turned the wrong way by one radian counts like."""
STEP_RAD = 1e-6


def curled(tree: BodyTree, side: Side) -> dict[str, float]:
    """Return the angles of the fingers of a hand that is closed around a bar, in [rad].

    By the published law, little fingers begin half a palm nearer to the wrist, where the bar is, and stay open.
    """
    opened = ("lf_knuckle",) if tree.development == "published" else ()
    curled = {name: 0.0 if name in opened else angle for name, angle in CURLED_DEG[tree.hands].items()}
    return {f"robot:{side}_{name}": deg_to_rad(angle) for name, angle in curled.items()}


def grip_point(tree: BodyTree, side: Side, radius_m: float) -> Vec3:
    """Return where the axis of a bar goes through a closed hand, in the hand's frame, in [m].

    The bar lies in the corner between palm and fingers, as far from the one as from the others; the hand's x axis is
    along the bar, to the side of the thumb.
    """
    palm = tree.geoms[f"{side}_hand1"]
    knuckles = next(body for body in tree.bodies if body.name == f"{side}_{KNUCKLES[tree.hands]}")
    away_m = radius_m + palm.size_m[1] + CLEAR_M
    inwards = -1.0 if side == "right" else 1.0
    before_m = away_m * math.tan(deg_to_rad(KNUCKLES_DEG) / 2)
    return palm.pos_m[0], palm.pos_m[1] + inwards * away_m, knuckles.pos_m[2] - before_m


def arm_to_bar(
    tree: BodyTree, angles_rad: Mapping[str, float], side: Side, point_m: Vec3, place_m: FloatArray, along: FloatArray
) -> dict[str, float]:
    """Return the angles of an arm and its wrist that bring a point of the hand to a bar, in [rad].

    Args:
        tree: The body.
        angles_rad: Of its other joints.
        side: Of the hand.
        point_m: The point, in the hand's frame.
        place_m: Where it is to be, shape (3,), in the frame of the hip.
        along: Where the hand's x axis is to point, a unit vector, shape (3,), in the frame of the hip.

    Raises:
        UnsupportedTaskError: If the arm does not get there.
    """
    names = [f"robot:{side}_{name}" for name in STRETCHED_OUT_DEG]
    low, high = np.deg2rad([tree.joints[name].range_deg for name in names]).T
    wanted = np.clip(np.deg2rad(list(STRETCHED_OUT_DEG.values())), low, high)
    # The parts of a body from the hip to one of them.
    bodies = {body.name: body for body in tree.bodies}
    way = [bodies[f"{side}_hand"]]
    while parent := way[0].parent:
        way = [bodies[parent], *way]
    chain = replace(tree, bodies=tuple(way))

    def misses(angles: FloatArray) -> FloatArray:
        """Return how far the point is off, then how far the hand is turned off, shape (6,), [m]."""
        placed = frames(chain, {**angles_rad, **dict(zip(names, angles.tolist(), strict=True))})
        origin, turn = placed[f"{side}_hand"]
        return np.concatenate([origin + turn @ point_m - place_m, TURN_M * (turn[:, 0] - along)])

    nearest = _search(misses, wanted, low, high)
    if np.abs(misses(nearest)).max() > CLEAR_M:
        raise UnsupportedTaskError(f"it starts with the hands at a rail; the {side} hand does not reach it")
    return dict(zip(names, np.round(nearest, 6).tolist(), strict=True))


def _search(
    misses: Callable[[FloatArray], FloatArray], wanted: FloatArray, low: FloatArray, high: FloatArray
) -> FloatArray:
    """Return angles between *low* and *high* with the least misses, near those that are *wanted*.

    Damped Newton steps (Levenberg 1944), at first drawn to what is wanted, later hardly so.
    """
    angles, shyness = wanted, SHYNESS
    steps = STEP_RAD * np.eye(len(wanted))
    for _ in range(ROUNDS):
        missed = misses(angles)
        slope = np.column_stack([(misses(angles + step) - missed) / STEP_RAD for step in steps])
        damped = slope.T @ slope + shyness**2 * np.eye(len(wanted))
        pull = slope.T @ missed + shyness**2 * (angles - wanted)
        angles = np.clip(angles - np.linalg.solve(damped, pull), low, high)
        shyness = max(FADING * shyness, LEAST_SHYNESS)
    return angles

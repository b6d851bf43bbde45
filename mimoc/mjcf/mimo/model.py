"""A model in which code that was written for MIMo finds all that it looks for.

This is what MIMo (1.1), BabyBench (its starter kit of 2025) and Lucignolo (0.1) look up by name or by place, beyond
what every bundle has: `lookups` has that. `docs/compatibility.md` says what was tried.
"""

import math
from dataclasses import replace

from mimoc.mjcf.infant import Camera, Node
from mimoc.mjcf.mimo.effectors import with_effectors
from mimoc.mjcf.mimo.motors import at_once
from mimoc.mjcf.mimo.servos import by_angle, pose_by_angle
from mimoc.mjcf.scene import SceneTree
from mimoc.mjcf.world import Mark

LOCATION = "mimo_location"
"""The body that the infant is in; its free joint has the same name."""
_AT_IT = (("mode", "targetbody"), ("target", LOCATION))
_QUARTER = math.pi / 2
_NARROW_DEG, _WIDE_DEG = 20.0, 45.0
CAMERAS = (
    Camera("corner", (3.0, -3.0, 3.0), (0.0, 0.0, 0.0), _NARROW_DEG, _AT_IT),
    Camera("top", (0.0, 0.0, 2.0), (0.0, 0.0, _QUARTER), _WIDE_DEG),
    Camera("side1", (2.0, 0.0, 0.5), (_QUARTER, _QUARTER, 0.0), _WIDE_DEG),
    Camera("side2", (0.0, 2.0, 0.5), (_QUARTER, math.pi, 0.0), _WIDE_DEG),
    Camera("closeup", (0.25, -0.25, 1.0), (0.0, 0.0, 0.0), _WIDE_DEG, _AT_IT),
)
"""BabyBench's, from where the infant starts."""
MARK_RADIUS_M = 0.01
MARKS = {"head": (0.8, 0.0, 0.0, 1.0), "left_hand": (0.0, 0.8, 0.0, 1.0), "right_hand": (0.15, 0.15, 1.0, 1.0)}
"""What Lucignolo places where a hand is to go, or the head to look, and its colour."""


def fit_infant(infant: SceneTree, model: str) -> SceneTree:
    """Return an infant, in no world yet, that is in a body of its own, with servos that take angles or plain motors.

    Args:
        infant: To change.
        model: How it is actuated.
    """
    located = replace(infant, roots=tuple(map(_located, infant.roots)))
    if model == "torque":
        return replace(located, actuator_defaults=at_once(infant.actuator_defaults))
    if model != "position":
        return located
    of_joint = {joint.name: joint.range_rad for root in infant.roots for node in _all(root) for joint in node.joints}
    ranges_rad = [of_joint[servo.joint] for servo in infant.actuators]
    return replace(
        located,
        actuators=tuple(map(by_angle, infant.actuators, ranges_rad)),
        keyframes=tuple(pose_by_angle(keyframe, ranges_rad) for keyframe in infant.keyframes),
    )


def fit_world(scene: SceneTree) -> SceneTree:
    """Return a scene with cameras around the infant, and marks to place."""
    x_m, y_m, *_ = scene.keyframes[0].qpos
    cameras = tuple(replace(camera, pos_m=_moved(camera.pos_m, x_m, y_m)) for camera in CAMERAS)
    marks = tuple(Mark(f"target:{part}", (0.0, 0.0, 0.0), MARK_RADIUS_M, rgba) for part, rgba in MARKS.items())
    return replace(scene, world=replace(scene.world, cameras=cameras, marks=marks))


def _located(root: Node) -> Node:
    """Return a body without a size, which moves freely, with the infant fixed to it."""
    return Node(
        name=LOCATION,
        pos_m=root.pos_m,
        euler_rad=root.euler_rad,
        free_joints=root.free_joints,
        joints=(),
        geoms=(),
        sites=(),
        cameras=(),
        children=(replace(with_effectors(root), pos_m=(0.0, 0.0, 0.0), euler_rad=(0.0, 0.0, 0.0), free_joints=()),),
    )


def _all(node: Node) -> list[Node]:
    """Return a body and all its descendants."""
    return [node, *(item for child in node.children for item in _all(child))]


def _moved(pos_m: tuple[float, float, float], x_m: float, y_m: float) -> tuple[float, float, float]:
    x, y, z = pos_m
    return x + x_m, y + y_m, z

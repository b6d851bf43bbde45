"""Where a fit starts: the resting infant, placed and turned as its trunk is seen in each frame."""

from dataclasses import dataclass

import numpy as np

from mimoc.motion.point_recording import MINI_RGBD_CAMERA, FloatArray, PointRecording
from mimoc.movement.retargeting.skeleton import exponential, rotation_vector

TRUNK = "neck", "left_hip", "right_hip"
SHOULDERS = "left_shoulder", "right_shoulder"
UPRIGHT = 0.7
"""Cosine of the angle between trunk and vertical from which an infant is not taken to lie."""


@dataclass(frozen=True)
class Start:
    """The root of an infant in each frame, and the height of the camera."""

    turned: FloatArray
    """Mean orientation of the root, shape (3, 3)."""
    root: FloatArray
    """Place, and rotation vector relative to the mean orientation, shape (t, 6)."""
    height_m: float
    lies: bool
    """Whether the trunk is closer to horizontal than to vertical."""
    face_down: float
    """Share of the frames in which the front of the trunk looks down."""


def start_of(
    recording: PointRecording,
    resting_m: FloatArray,
    root_m: FloatArray,
    turned: FloatArray,
    height_m: float | None,
    turn: FloatArray,
) -> Start:
    """Return where to start, from a recording without gaps.

    *resting_m* are neck, left and right hip of the infant on its back on the floor, shape (3, 3), with its root at
    *root_m*, of the orientation *turned*; *turn* is `camera_from_world`. A height of the camera that is not known
    follows, in two dimensions, from the trunk's length.
    """
    if recording.unit == "px" and recording.depth_m is None:
        return _of_pixels(recording, resting_m, root_m, turned, height_m, turn)
    seen_m, height_m = _in_space(recording, height_m, root_m[2], turn)
    return _of_places(seen_m, resting_m, root_m, turned, height_m)


def on_ground(recording: PointRecording, turn: FloatArray) -> FloatArray:
    """Return where rays to pixels meet a level plane one unit below the camera, shape (t, k, 2); NaN above it."""
    camera = recording.camera or MINI_RGBD_CAMERA
    across = (recording.positions - camera.centre_px) / camera.focal_px
    rays = np.concatenate([across, np.ones((*across.shape[:2], 1))], axis=-1) @ turn
    return np.where(rays[..., 2:] < 0, rays[..., :2] / np.maximum(-rays[..., 2:], 1e-9), np.nan)


def _of_pixels(
    recording: PointRecording,
    resting_m: FloatArray,
    root_m: FloatArray,
    turned: FloatArray,
    height_m: float | None,
    turn: FloatArray,
) -> Start:
    neck, hips = resting_m[0], resting_m[1:].mean(axis=0)
    ground, names = on_ground(recording, turn), recording.names
    place = {name: ground[:, names.index(name)] for name in (*TRUNK, *({*SHOULDERS} & {*names}))}
    a, b = place["neck"], (place["left_hip"] + place["right_hip"]) / 2
    if height_m is None:
        trunk = np.nanpercentile(np.linalg.norm(a - b, axis=1), 75)
        height_m = float(np.linalg.norm((neck - hips)[:2]) / trunk + neck[2])
    a, b = (height_m - neck[2]) * a, (height_m - neck[2]) * b
    face_down = _face_down(a - b, *(place[name] for name in SHOULDERS)) if {*SHOULDERS} <= {*names} else 0.0
    if face_down > 0.5:
        # The infant is turned about the long axis of its trunk to its front.
        axis = (neck - hips) * [1.0, 1.0, 0.0]
        half = exponential(np.pi * (axis / np.linalg.norm(axis))[None])[0][0]
        turned, neck, hips = half @ turned, root_m + half @ (neck - root_m), root_m + half @ (hips - root_m)
    yaw = np.unwrap(np.arctan2(*(a - b).T[::-1])) - np.arctan2(*(neck - hips)[1::-1])
    mean = float(np.median(yaw))
    root = np.zeros((len(a), 6))
    root[:, 5] = yaw - mean
    offset = exponential(np.stack([0 * yaw, 0 * yaw, yaw], axis=-1))[0] @ (root_m - (neck + hips) / 2)
    root[:, :3] = offset + np.concatenate([(a + b) / 2, np.full((len(a), 1), (neck + hips)[2] / 2)], axis=1)
    return Start(exponential(np.array([[0.0, 0.0, mean]]))[0][0] @ turned, root, height_m, True, face_down)


def _face_down(up: FloatArray, left: FloatArray, right: FloatArray) -> float:
    """Return the share of frames in which shoulders are swapped: from above, a supine left is to the right of up."""
    across = left - right
    return float(np.mean(up[:, 0] * across[:, 1] - up[:, 1] * across[:, 0] > 0))


def _in_space(
    recording: PointRecording, height_m: float | None, resting_m: float, turn: FloatArray
) -> tuple[FloatArray, float]:
    """Return neck and hips in the world, shape (t, 3, 3), and the height; they lie as high as the resting infant's."""
    index = [recording.names.index(name) for name in TRUNK]
    if recording.depth_m is None:
        lowest = np.nanpercentile(recording.positions[:, index, 2], 10)
        offset = height_m if height_m is not None else float(lowest - resting_m)
        return recording.positions[:, index] - [0.0, 0.0, offset], offset
    camera = recording.camera or MINI_RGBD_CAMERA
    depth = recording.depth_m[:, index, None]
    across = (recording.positions[:, index] - camera.centre_px) / camera.focal_px * depth
    below = np.concatenate([across, depth], axis=-1) @ turn
    height_m = height_m if height_m is not None else float(resting_m - np.nanpercentile(below[..., 2], 10))
    return below + np.array([0.0, 0.0, height_m]), height_m


def _of_places(
    seen_m: FloatArray, resting_m: FloatArray, root_m: FloatArray, turned: FloatArray, height_m: float
) -> Start:
    """Return the start from neck and hips in space: their triangle is laid on the model's in each frame."""
    model = _frame(resting_m)
    turns = np.array([_frame(triangle) @ model.T for triangle in seen_m])
    left, _, right = np.linalg.svd(np.mean(turns[np.isfinite(turns).all((1, 2))], axis=0))
    mean = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    vectors = np.array([rotation_vector(turn @ mean.T) for turn in turns])
    places = seen_m.mean(axis=1) + turns @ (root_m - resting_m.mean(axis=0))
    lies = abs((mean @ model)[2, 0]) < UPRIGHT
    face_down = float(np.mean((turns @ model)[:, 2, 2] < 0)) if lies else 0.0
    return Start(mean @ turned, np.concatenate([places, _continuous(vectors)], axis=1), height_m, bool(lies), face_down)


def _frame(triangle: FloatArray) -> FloatArray:
    """Return the axes of a trunk as columns: up along it, to its left, and forwards."""
    neck, left, right = triangle
    up = neck - (left + right) / 2
    up = up / np.linalg.norm(up)
    across = left - right - ((left - right) @ up) * up
    across = across / np.linalg.norm(across)
    return np.stack([up, across, np.cross(across, up)], axis=1)


def _continuous(vectors: FloatArray) -> FloatArray:
    """Return rotation vectors without jumps: w and w (1 - 2 pi / |w|) are the same rotation."""
    result = vectors.copy()
    for index in range(1, len(result)):
        angle = np.linalg.norm(result[index])
        if angle > 1e-6:
            other = result[index] * (1 - 2 * np.pi / angle)
            if np.linalg.norm(other - result[index - 1]) < np.linalg.norm(result[index] - result[index - 1]):
                result[index] = other
    return result

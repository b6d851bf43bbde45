"""Where a fit starts: the resting infant, placed and turned as its trunk is seen in each frame."""

from dataclasses import dataclass

import numpy as np

from mimoc.motion.point_recording import MINI_RGBD_CAMERA, FloatArray, PointRecording
from mimoc.retargeting.skeleton import exponential, rotation_vector

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


def start_of(
    recording: PointRecording, resting_m: FloatArray, root_m: FloatArray, turned: FloatArray, height_m: float | None
) -> Start:
    """Return where to start.

    Args:
        recording: The recording, without gaps.
        resting_m: Neck, left and right hip of the infant that lies on its back on the floor, shape (3, 3).
        root_m: Its root, shape (3,).
        turned: Orientation of its root, shape (3, 3).
        height_m: Height of the camera; if it is not known, of two dimensions it follows from the trunk's length.
    """
    if recording.unit == "px" and recording.depth_m is None:
        return _of_pixels(recording, resting_m, root_m, turned, height_m)
    seen_m, height_m = _in_space(recording, height_m, root_m[2])
    return _of_places(seen_m, resting_m, root_m, turned, height_m)


def _of_pixels(
    recording: PointRecording, resting_m: FloatArray, root_m: FloatArray, turned: FloatArray, height_m: float | None
) -> Start:
    camera = recording.camera or MINI_RGBD_CAMERA
    focal, centre = np.array(camera.focal_px), np.array(camera.centre_px)
    neck, hips = resting_m[0], resting_m[1:].mean(axis=0)
    trunk = np.linalg.norm(recording.path("neck") - recording.hips, axis=1)
    if height_m is None:
        height_m = float(focal.mean() * np.linalg.norm((neck - hips)[:2]) / np.percentile(trunk, 75) + neck[2])
    ground = (recording.positions - centre) / focal * [1.0, -1.0] * (height_m - neck[2])
    names = recording.names
    a, b = (
        ground[:, names.index("neck")],
        (ground[:, names.index("left_hip")] + ground[:, names.index("right_hip")]) / 2,
    )
    if set(SHOULDERS) <= set(names) and _is_prone(a - b, *(ground[:, names.index(name)] for name in SHOULDERS)):
        turned, neck, hips = _rolled_over(turned, neck, hips, root_m)
    yaw = np.unwrap(np.arctan2(*(a - b).T[::-1])) - np.arctan2(*(neck - hips)[1::-1])
    mean = float(np.median(yaw))
    root = np.zeros((len(a), 6))
    root[:, 5] = yaw - mean
    offset = exponential(np.stack([0 * yaw, 0 * yaw, yaw], axis=-1))[0] @ (root_m - (neck + hips) / 2)
    root[:, :3] = offset + np.concatenate([(a + b) / 2, np.full((len(a), 1), (neck + hips)[2] / 2)], axis=1)
    return Start(exponential(np.array([[0.0, 0.0, mean]]))[0][0] @ turned, root, height_m, True)


def _is_prone(up: FloatArray, left: FloatArray, right: FloatArray) -> bool:
    """Return whether shoulders are seen swapped from above: of one who lies on its back, left is to the right of up."""
    across = left - right
    return bool(np.median(up[:, 0] * across[:, 1] - up[:, 1] * across[:, 0]) > 0)


def _rolled_over(
    turned: FloatArray, neck: FloatArray, hips: FloatArray, root_m: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the infant turned about the long axis of its trunk to its front."""
    axis = (neck - hips) * [1.0, 1.0, 0.0]
    half = exponential(np.pi * (axis / np.linalg.norm(axis))[None])[0][0]
    return half @ turned, root_m + half @ (neck - root_m), root_m + half @ (hips - root_m)


def _in_space(recording: PointRecording, height_m: float | None, resting_m: float) -> tuple[FloatArray, float]:
    """Return neck and hips in the world, shape (t, 3, 3), and the height; they lie as high as the resting infant's."""
    index = [recording.names.index(name) for name in TRUNK]
    if recording.depth_m is None:
        lowest = np.nanpercentile(recording.positions[:, index, 2], 10)
        offset = height_m if height_m is not None else float(lowest - resting_m)
        return recording.positions[:, index] - [0.0, 0.0, offset], offset
    camera = recording.camera or MINI_RGBD_CAMERA
    depth = recording.depth_m[:, index]
    across = (recording.positions[:, index] - camera.centre_px) / camera.focal_px * depth[..., None]
    height_m = height_m if height_m is not None else float(np.nanpercentile(depth, 90) + resting_m)
    return np.stack([across[..., 0], -across[..., 1], height_m - depth], axis=-1), height_m


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
    return Start(mean @ turned, np.concatenate([places, _continuous(vectors)], axis=1), height_m, bool(lies))


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

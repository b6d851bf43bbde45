"""Recordings of points on a body whose limbs move as a test says."""

from dataclasses import replace

import numpy as np

from mimoc.motion.labels import MINI_RGBD_POINTS
from mimoc.motion.point_recording import FloatArray, PointRecording

TRUNK_PX = 100.0
REST = {  # Where points are at rest, x to the right and y downwards, [trunk] from the middle of the hips.
    "head": (0.0, -1.3),
    "neck": (0.0, -1.0),
    "left_shoulder": (0.3, -0.9),
    "left_elbow": (0.6, -0.7),
    "left_hand": (0.8, -0.4),
    "left_hip": (0.2, 0.0),
    "left_knee": (0.4, 0.4),
    "left_foot": (0.3, 0.8),
}


def moving(paths: dict[str, FloatArray], seconds: float = 33.0, rate_hz: float = 30.0) -> PointRecording:
    """Return a body at rest, some of whose points leave their places by paths, shape (t, 2), [trunk]."""
    count = round(seconds * rate_hz)
    positions = np.empty((count, len(MINI_RGBD_POINTS), 2))
    for index, name in enumerate(MINI_RGBD_POINTS):
        x, y = REST[name.replace("right", "left")]
        positions[:, index] = (-x if name.startswith("right") else x, y)
        positions[:, index] += paths.get(name, 0.0)
    return PointRecording("moving", rate_hz, MINI_RGBD_POINTS, TRUNK_PX * positions, np.ones(positions.shape[:2]))


def restless(seed: int = 0, seconds: float = 33.0, rate_hz: float = 30.0) -> PointRecording:
    generator, count = np.random.default_rng(seed), round(seconds * rate_hz)
    times_s = np.arange(count) / rate_hz
    paths = {}
    for name in MINI_RGBD_POINTS:
        if name.split("_")[-1] in ("elbow", "hand", "knee", "foot"):
            rates_hz, phases = generator.uniform(0.1, 2.0, (6, 2)), generator.uniform(0, 2 * np.pi, (6, 2))
            waves = np.sin(2 * np.pi * rates_hz * times_s[:, None, None] + phases)
            bursts = 0.5 + 0.5 * np.sin(2 * np.pi * 0.1 * times_s + generator.uniform(0, 6))
            paths[name] = 0.06 * waves.sum(axis=1) * bursts[:, None]
    return moving(paths, seconds, rate_hz)


def wave(rate_hz: float, amplitude: float, seconds: float = 33.0, frames_hz: float = 30.0) -> FloatArray:
    """Return a path along the trunk, shape (t, 2)."""
    times_s = np.arange(round(seconds * frames_hz)) / frames_hz
    return np.stack([np.zeros_like(times_s), amplitude * np.sin(2 * np.pi * rate_hz * times_s)], axis=-1)


def placed(recording: PointRecording, positions: FloatArray, names: tuple[str, ...] | None = None) -> PointRecording:
    return replace(recording, positions=positions, names=names or recording.names)

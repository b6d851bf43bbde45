"""Directions of body parts in the world."""

import mujoco
import numpy as np


def tilt_deg(data: mujoco.MjData, body: int) -> float:
    """Return the angle between a body's own upward axis and the vertical."""
    return float(np.degrees(np.arccos(np.clip(data.xmat[body, 8], -1.0, 1.0))))


def elevation_deg(data: mujoco.MjData, body: int) -> float:
    """Return how far a body faces up: 90 degrees for straight up, -90 for straight down."""
    return float(np.degrees(np.arcsin(np.clip(data.xmat[body, 6], -1.0, 1.0))))


def rise_deg(data: mujoco.MjData, start: int, end: int) -> float:
    """Return the elevation of the line from one body's origin to another's: 90 degrees for straight up."""
    line_m = data.xpos[end] - data.xpos[start]
    return float(np.degrees(np.arctan2(line_m[2], np.hypot(line_m[0], line_m[1]))))

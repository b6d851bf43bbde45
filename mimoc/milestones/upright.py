"""Directions of body parts in the world."""

import mujoco
import numpy as np


def tilt_deg(data: mujoco.MjData, body: int) -> float:
    """Return the angle between a body's own upward axis and the vertical."""
    return float(np.degrees(np.arccos(np.clip(data.xmat[body, 8], -1.0, 1.0))))


def elevation_deg(data: mujoco.MjData, body: int) -> float:
    """Return how far a body faces up: 90 degrees for straight up, -90 for straight down."""
    return float(np.degrees(np.arcsin(np.clip(data.xmat[body, 6], -1.0, 1.0))))

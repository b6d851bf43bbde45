"""How far an infant that leans over reaches the floor."""

import numpy as np

LEAN_DEG = 60.0
"""How far a sitting infant leans over to reach something."""


def leaning_reach(arm_m: float, shoulder_m: float, hip_m: float) -> float:
    """Return how far from its hip, seen from above, an infant reaches the floor: it leans over, or else crouches."""
    lean = np.radians(np.linspace(0.0, LEAN_DEG, 16))
    ahead_m, height_m = (shoulder_m - hip_m) * np.sin(lean), hip_m + (shoulder_m - hip_m) * np.cos(lean)
    reaches_floor = height_m < arm_m
    if not reaches_floor.any():
        return arm_m
    return float((ahead_m + np.sqrt(np.maximum(arm_m**2 - height_m**2, 0.0)))[reaches_floor].max())

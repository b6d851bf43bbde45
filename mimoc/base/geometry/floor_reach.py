"""What an infant reaches: the floor when it leans over, and places around a hand, in the order of their search."""

import math
from collections.abc import Iterator

import numpy as np

LEAN_DEG = 60.0
"""How far a sitting infant leans over to reach something."""
STRETCHED = 0.6
"""How far from the shoulder an object is in the air within reach, in lengths of the arm."""


def leaning_reach(arm_m: float, shoulder_m: float, hip_m: float) -> float:
    """Return how far from its hip, seen from above, an infant reaches the floor: it leans over, or else crouches."""
    lean = np.radians(np.linspace(0.0, LEAN_DEG, 16))
    ahead_m, height_m = (shoulder_m - hip_m) * np.sin(lean), hip_m + (shoulder_m - hip_m) * np.cos(lean)
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

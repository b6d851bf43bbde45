"""A plain search for where a body rests, one pitch at a time: the reference of the tests."""

import math
from itertools import count, pairwise

import numpy as np

from mimoc.body.kinematics import pose
from mimoc.body.poses import pose_angles

STEP_RAD = math.radians(0.5)
GOLDEN = (math.sqrt(5) - 1) / 2


def rest(tree, wanted, precision_rad: float = 1e-7) -> tuple[float, float]:
    """Return the pitch at which a body in a pose comes to rest, in [rad], and the height of its hip there, in [m]."""
    posed = pose(tree, pose_angles(tree, wanted))
    start = math.radians(wanted.pitch_deg)

    def height(pitch_rad: float) -> float:
        down = np.array([math.sin(pitch_rad), 0.0, -math.cos(pitch_rad)])
        return posed.solid.extent(down) - float(down @ posed.centre_of_mass)

    step = -STEP_RAD if height(start - STEP_RAD) < height(start + STEP_RAD) else STEP_RAD
    steps = (start + step * number for number in count())
    lowest = next(here for here, there in pairwise(steps) if height(there) >= height(here))
    low, high = lowest - STEP_RAD, lowest + STEP_RAD
    while high - low > precision_rad:
        left, right = high - GOLDEN * (high - low), low + GOLDEN * (high - low)
        low, high = (low, right) if height(left) < height(right) else (left, high)
    pitch_rad = (low + high) / 2
    down = np.array([math.sin(pitch_rad), 0.0, -math.cos(pitch_rad)])
    return pitch_rad, posed.solid.extent(down)

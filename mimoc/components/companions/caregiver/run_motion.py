"""Movements of a caregiver: from rest to rest along smooth paths, at an adult's speeds."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.base.geometry.adult import Palm
from mimoc.base.geometry.rotations import FloatArray

PEAK_M_S = 0.6
"""Peak speed of a hand: about that of reaches over 30 cm without haste (Flash & Hogan 1985, J Neurosci 5: 1688; from
memory)."""
PEAK_RAD_S = math.radians(150)
"""Peak speed of a turn of the head: about that of gaze shifts of 60 deg without haste (Guitton & Volle 1987, J
Neurophysiol 58: 427; from memory)."""
PEAK = 1.875
"""Peak speed of a movement of minimum jerk, by its mean speed (Flash & Hogan 1985)."""
SHORTEST_S = 0.3
"""Duration of the shortest movements; an assumption."""


def minimum_jerk(share: float) -> float:
    """Return how much of a movement is done after a share of its time: 10 s³ - 15 s⁴ + 6 s⁵ (Flash & Hogan 1985)."""
    share = min(max(share, 0.0), 1.0)
    return share**3 * (10 - 15 * share + 6 * share**2)


def duration_s(length: float, peak: float) -> float:
    """Return how long a movement takes, from its length and its peak speed, in any unit of length."""
    return max(PEAK * length / peak, SHORTEST_S)


@dataclass
class HandPath:
    """A movement of a palm along a parabola: from its start by way of a point to its end."""

    start_m: FloatArray
    by_m: FloatArray
    """Control point of the parabola: the palm comes to its end from there."""
    end_m: FloatArray
    start_normal: FloatArray
    end_normal: FloatArray
    steps: int
    """Physics steps that it takes."""
    done: int = 0

    @classmethod
    def between(cls, start: Palm, end: Palm, by_m: FloatArray, timestep_s: float) -> "HandPath":
        """Return a movement that begins now."""
        length_m = float(np.linalg.norm(by_m - start.place_m) + np.linalg.norm(end.place_m - by_m))
        steps = math.ceil(duration_s(length_m, PEAK_M_S) / timestep_s)
        return cls(start.place_m, by_m, end.place_m, start.normal, end.normal, steps)

    @property
    def is_done(self) -> bool:
        """Whether the palm is at its end."""
        return self.done >= self.steps

    def at(self, done: int) -> Palm:
        """Return where the palm is after some of its steps."""
        share = minimum_jerk(done / self.steps)
        rest = 1 - share
        place_m = rest**2 * self.start_m + 2 * rest * share * self.by_m + share**2 * self.end_m
        normal = rest * self.start_normal + share * self.end_normal
        length = float(np.linalg.norm(normal))
        return Palm(place_m, normal / length if length > 1e-6 else self.end_normal)

    @property
    def state(self) -> dict[str, Any]:
        """All of it, to be copied."""
        return dict(vars(self))


def turned(start: FloatArray, end: FloatArray, share: float) -> FloatArray:
    """Return the rotation after a share of the shortest turn from one to another, shape (3, 3)."""
    axis, angle_rad = turn_between(start, end)
    return _about(axis, share * angle_rad) @ start


def turn_between(start: FloatArray, end: FloatArray) -> tuple[FloatArray, float]:
    """Return axis and angle of the shortest turn from one rotation to another."""
    turn = end @ start.T
    angle_rad = math.acos(min(max((float(np.trace(turn)) - 1) / 2, -1.0), 1.0))
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]])
    length = float(np.linalg.norm(axis))
    return (axis / length, angle_rad) if length > 1e-9 else (np.array([0.0, 0.0, 1.0]), 0.0)


def _about(axis: FloatArray, angle_rad: float) -> FloatArray:
    """Return the rotation about a unit vector, shape (3, 3) (Rodrigues 1840)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + math.sin(angle_rad) * cross + (1 - math.cos(angle_rad)) * (cross @ cross)

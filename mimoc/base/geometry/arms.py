"""Where the parts of an arm are that ends at some place: two links and a hand, the elbow down and outwards."""

import math
from dataclasses import dataclass

import numpy as np

from mimoc.base.geometry.leaning import UP, Frame
from mimoc.base.geometry.rotations import FloatArray

LIMIT = 0.995
"""Share of its length that an arm is stretched to at most."""

DOWNWARD = 0.8
"""How much further down than out an elbow is bent; an assumption."""
LOW_M, HIGHER_M = 0.3, 0.2
"""Height of a shoulder above the floor at which the elbow is neither lower nor higher, and how much more it takes for
all of that."""


@dataclass(frozen=True, slots=True)
class Links:
    """Lengths of an arm, in [m]."""

    upper_arm_m: float
    forearm_m: float
    palm_m: float
    """From the wrist to the middle of the palm."""

    @property
    def reach_m(self) -> float:
        """How far the wrist gets from the shoulder."""
        return LIMIT * (self.upper_arm_m + self.forearm_m)


def reach(
    links: Links, shoulder_m: FloatArray, palm_m: FloatArray, normal: FloatArray, outward: FloatArray
) -> tuple[Frame, Frame, Frame]:
    """Return upper arm, forearm and hand of an arm whose palm is at a place, or as near as it gets.

    With a and b the lengths of both links and d the distance from shoulder to wrist, the elbow is at
    p = (a² - b² + d²) / 2d along the way and √(a² - p²) beside it. Each part has its origin at its near end and z along
    itself; x of the hand is where the palm looks.

    Args:
        links: Lengths of the arm.
        shoulder_m: The shoulder, shape (3,).
        palm_m: Where the middle of the palm is to be, shape (3,).
        normal: Where the palm is to look, shape (3,), as far as the arm lets it.
        outward: To the side of this arm, a unit vector, shape (3,).
    """
    along = _unit(palm_m - shoulder_m, outward)
    way = palm_m - links.palm_m * along - shoulder_m
    far_m = float(np.linalg.norm(way))
    nearest_m = abs(links.upper_arm_m - links.forearm_m) + 0.02
    distance_m = min(max(far_m, nearest_m), links.reach_m)
    along_wrist = _unit(way, along)
    wrist_m = shoulder_m + distance_m * along_wrist
    part_m = (links.upper_arm_m**2 - links.forearm_m**2 + distance_m**2) / (2 * distance_m)
    beside_m = math.sqrt(max(links.upper_arm_m**2 - part_m**2, 0.0))
    height = min(max((float(shoulder_m[2]) - LOW_M) / HIGHER_M, -1.0), 1.0)  # The elbow keeps off the floor.
    bend = outward - DOWNWARD * height * UP
    bend = _unit(bend - (bend @ along_wrist) * along_wrist, _some_across(along_wrist))
    elbow_m = shoulder_m + part_m * along_wrist + beside_m * bend
    palm = _unit(normal - (normal @ along) * along, _some_across(along))
    hand = np.column_stack([palm, np.cross(along, palm), along])
    return _link(shoulder_m, elbow_m, bend), _link(elbow_m, wrist_m, bend), (wrist_m, hand)


def _link(start_m: FloatArray, end_m: FloatArray, side: FloatArray) -> Frame:
    along = (end_m - start_m) / np.linalg.norm(end_m - start_m)
    across = _unit(side - (side @ along) * along, _some_across(along))
    return start_m, np.column_stack([across, np.cross(along, across), along])


def _unit(vector: FloatArray, otherwise: FloatArray) -> FloatArray:
    """Return a vector with a length of 1, or another one if it has hardly any."""
    length = float(np.linalg.norm(vector))
    return vector / length if length > 1e-9 else otherwise


def _some_across(axis: FloatArray) -> FloatArray:
    other = np.eye(3)[np.abs(axis).argmin()]
    across = other - (other @ axis) * axis
    return across / np.linalg.norm(across)

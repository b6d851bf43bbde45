"""An adult's lengths, and where its parts are when its head, trunk and palms are somewhere."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from mimoc.base.geometry.reach import UP, Figure, Frame, Leaning
from mimoc.base.geometry.rotations import FloatArray

Side = Literal["left", "right"]
SIDES: tuple[Side, Side] = ("left", "right")
SIGNS: Mapping[Side, float] = {"left": 1.0, "right": -1.0}  # Along y of the trunk.

STATURE_M = 1.63
"""Stature of the adult that these lengths are of: about the mean of women (ANSUR, Gordon et al. 1989; from memory)."""
HEAD_M = (0.094, 0.073, 0.112)  # Half of the length, breadth and height of the head: 18.7, 14.6 and 22.4 cm (likewise).
NECK_M = (0.03, 0.148)  # From the centre of the head to the base of the neck: backwards, and down; an assumption.
TRUNK_M, HIP_M = 0.50, 0.11  # From the base of the neck to the hips, and half of the trunk's depth; an assumption.
SHOULDER_M = (0.0, 0.165, -0.035)
"""The left shoulder from the base of the neck: forwards, to the left and up; a breadth of 36 cm over both upper arms
(likewise)."""
UPPER_ARM_M, FOREARM_M = 0.31, 0.243  # From shoulder to elbow, and from elbow to wrist (likewise).
PALM_M = 0.075  # From the wrist to the middle of the palm; an assumption.
MOUTH_M = (0.095, 0.0, -0.055)  # The mouth from the centre of the head; an assumption.
REST_M = (0.24, 0.13, 0.06)
"""Where palms rest: forwards and outwards from the shoulder, and the least height above the floor; an assumption."""
HANGING_M = 0.40  # How far below the shoulder palms rest at most.

LIMIT = 0.995  # Share of its length that an arm is stretched to at most.
DOWNWARD = 0.8  # Greatest ratio of down to outwards in the direction in which an elbow is bent; an assumption.
LEVEL_M, RANGE_M = 0.3, 0.2
"""A shoulder LEVEL_M above the floor bends its elbow straight outwards; RANGE_M higher or more, as far down as DOWNWARD
says; RANGE_M lower or more, as far up, which keeps the elbow off the floor."""


@dataclass(frozen=True, slots=True)
class Links:
    """Lengths of an arm, in [m]."""

    upper_arm_m: float
    forearm_m: float
    palm_m: float  # From the wrist to the middle of the palm.

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
    downward = min(max((float(shoulder_m[2]) - LEVEL_M) / RANGE_M, -1.0), 1.0)
    bend = outward - DOWNWARD * downward * UP
    bend = _unit(bend - (bend @ along_wrist) * along_wrist, _across(along_wrist))
    elbow_m = shoulder_m + part_m * along_wrist + beside_m * bend
    palm = _unit(normal - (normal @ along) * along, _across(along))
    hand = np.column_stack([palm, np.cross(along, palm), along])
    return _link(shoulder_m, elbow_m, bend), _link(elbow_m, wrist_m, bend), (wrist_m, hand)


def _link(start_m: FloatArray, end_m: FloatArray, side: FloatArray) -> Frame:
    along = (end_m - start_m) / np.linalg.norm(end_m - start_m)
    across = _unit(side - (side @ along) * along, _across(along))
    return start_m, np.column_stack([across, np.cross(along, across), along])


def _unit(vector: FloatArray, otherwise: FloatArray) -> FloatArray:
    """Return a vector scaled to a length of 1, or *otherwise* if its length is almost 0."""
    length = float(np.linalg.norm(vector))
    return vector / length if length > 1e-9 else otherwise


def _across(axis: FloatArray) -> FloatArray:
    """Return a unit vector perpendicular to an axis, shape (3,)."""
    least_along = np.eye(3)[np.abs(axis).argmin()]
    across = least_along - (least_along @ axis) * axis
    return across / np.linalg.norm(across)


@dataclass(frozen=True, slots=True)
class Palm:
    """Where the middle of a palm is, and where it looks."""

    place_m: FloatArray  # Shape (3,).
    normal: FloatArray  # Unit vector, shape (3,).


@dataclass(frozen=True, slots=True)
class Adult:
    """An adult of some size."""

    scale: float  # Ratio of its stature to `STATURE_M`.

    @property
    def figure(self) -> Figure:
        """The lengths by which it leans."""
        scale = self.scale
        face_m, _, crown_m = HEAD_M
        back_m, down_m = NECK_M
        return Figure(
            face_m=scale * face_m,
            crown_m=scale * crown_m,
            neck_m=(scale * back_m, scale * down_m),
            trunk_m=scale * TRUNK_M,
            hip_m=HIP_M,  # The hips' height above the floor is the same at any stature.
        )

    @property
    def links(self) -> Links:
        """The lengths of its arms."""
        return Links(self.scale * UPPER_ARM_M, self.scale * FOREARM_M, self.scale * PALM_M)

    def shoulder_m(self, trunk: Frame, side: Side) -> FloatArray:
        """Return where a shoulder is, shape (3,)."""
        x, y, z = SHOULDER_M
        return trunk[0] + trunk[1] @ (self.scale * np.array([x, SIGNS[side] * y, z]))

    def resting(self, trunk: Frame, side: Side, wider_m: float = 0.0) -> Palm:
        """Return where a palm rests: on the floor in front of it or over it, perhaps farther out; it looks down."""
        forward_m, outward_m, least_m = REST_M
        shoulder_m = self.shoulder_m(trunk, side)
        forward = np.array([trunk[1][0, 0], trunk[1][1, 0], 0.0])
        if np.linalg.norm(forward) < 0.2:  # The trunk is level, so that forwards is where the spine points to.
            forward = np.array([trunk[1][0, 2], trunk[1][1, 2], 0.0])
        forward /= np.linalg.norm(forward)
        outward = SIGNS[side] * trunk[1][:, 1]
        place_m = shoulder_m + self.scale * forward_m * forward + (self.scale * outward_m + wider_m) * outward
        place_m[2] = max(shoulder_m[2] - self.scale * HANGING_M, least_m)
        return Palm(place_m, -UP)

    def arm(self, trunk: Frame, side: Side, palm: Palm) -> tuple[Frame, Frame, Frame]:
        """Return upper arm, forearm and hand of an arm; see `reach`."""
        outward = SIGNS[side] * trunk[1][:, 1]
        return reach(self.links, self.shoulder_m(trunk, side), palm.place_m, palm.normal, outward)


def neck(leaning: Leaning) -> Frame:
    """Return the neck, along z from its base to the centre of the head."""
    base_m, trunk = leaning.trunk
    along = (leaning.head[0] - base_m) / np.linalg.norm(leaning.head[0] - base_m)
    side = trunk[:, 1] - (trunk[:, 1] @ along) * along
    side /= np.linalg.norm(side)
    return base_m, np.column_stack([np.cross(side, along), side, along])

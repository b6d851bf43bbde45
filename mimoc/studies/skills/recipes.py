"""What kinds of movements are tried for a skill: how many postures, in what order, and what is the same on both sides.

A movement is made of a vector of numbers, so that any search can find it:

    vector (v,)  ->  postures (p, n), in shares of the ranges of n joints, and how they follow what is felt, (4, n)
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mimoc.policies.postures import Postures, mirrored
from mimoc.runtime.sense import FloatArray

TRUNK = ("hip_bend1", "hip_lean1", "hip_rot1")
LIMBS = ("shoulder_horizontal", "shoulder_ad_ab", "elbow", "hip1", "hip2", "knee")
ROLLING = (*TRUNK, "head_swivel", "head_tilt", *LIMBS, "shoulder_rotation", "hip3")
UPRIGHT = (*TRUNK, "head_tilt", *LIMBS, "foot1", "foot2")
HOLDING = ("hand1", "hand2", "hand3", "fingers")
"""Joints that move, without `robot:` and without their side; all others are left quiet, so that a search has fewer
numbers. `fingers` are all of their joints."""
FINGERS = ("th", "ff", "mf", "rf", "lf")
SWAY_STEP = 0.5  # What a unit of the vector is of a gain from what is felt to a share.


@dataclass(frozen=True)
class Recipe:
    """A kind of movement."""

    joints: tuple[str, ...]  # The joints that move, without their side.
    postures: int
    posture_s: float
    moving_s: float
    is_symmetric: bool = False  # Whether both sides do the same, but for what is felt of falling to a side.
    repeats: bool = False
    is_mirrored: bool = False  # Whether both sides take turns.
    sways: bool = False  # Whether the infant leans against falling over.
    spread: float = 0.6
    """Of the first draws around where the infant begins, or around no command, in shares of half a range."""
    stiffness_per_rad: float = 0.0
    """Share of strength for each radian off a posture; 0 for movements of commands, drawn around none."""


_HELD = Recipe(UPRIGHT, 1, 1.0, 0.2, True, sways=True, spread=0.15, stiffness_per_rad=1.0)
RECIPES: Mapping[str, Recipe] = {
    "roll": Recipe(ROLLING, 3, 1.0, 0.4, spread=0.7),
    "sit_up": Recipe(ROLLING, 3, 1.0, 0.4, spread=1.0),
    "sit": _HELD,
    "crawl": Recipe(ROLLING, 2, 0.4, 0.3, repeats=True, is_mirrored=True, spread=0.6),
    "pull_to_stand": Recipe(UPRIGHT, 2, 1.5, 1.0, True, sways=True),
    "stand": _HELD,
    "cruise": Recipe(UPRIGHT, 2, 0.4, 0.3, repeats=True, spread=0.2, sways=True, stiffness_per_rad=1.0),
    "walk": Recipe(UPRIGHT, 2, 0.3, 0.2, repeats=True, is_mirrored=True, sways=True, spread=0.2, stiffness_per_rad=1.0),
    "grasp": Recipe(HOLDING, 2, 1.0, 0.4, spread=0.5),
}


class Form:
    """From vectors to movements of an infant."""

    def __init__(self, recipe: Recipe, task: str, age_months: float, joints: tuple[str, ...], start: FloatArray):
        """Say what a movement is made of; hinges that can be commanded start at shares of their range, shape (n,)."""
        kept = [place for place, joint in enumerate(joints) if _name(joint) in recipe.joints]
        self.recipe, self.task, self.age_months = recipe, task, age_months
        self.joints = tuple(joints[place] for place in kept)
        self._start = np.clip(start[kept], -1.0, 1.0) if recipe.stiffness_per_rad else np.zeros(len(kept))
        one_side = np.eye(len(self.joints))[[place for place, joint in enumerate(self.joints) if "left_" not in joint]]
        other_side = mirrored(self.joints, one_side)
        alike, opposite = np.sign(one_side + other_side), np.sign(one_side - other_side)
        # Postures in which both sides do the same, and in which they do the opposite, shape (b, n) each.
        self._alike, self._opposite = alike[alike.any(axis=1)], opposite[opposite.any(axis=1)]
        self._of_posture = self._alike if recipe.is_symmetric else np.eye(len(kept))
        self._of_sway = (self._alike, self._opposite) * 2 if recipe.sways else ()

    @property
    def sizes(self) -> list[int]:
        """Number of numbers of each posture, then of each row of the sway."""
        return [len(self._of_posture)] * self.recipe.postures + [len(basis) for basis in self._of_sway]

    def scale(self) -> FloatArray:
        """Return by how much the numbers of first draws spread, shape (v,)."""
        return np.full(sum(self.sizes), self.recipe.spread)

    def movement(self, vector: FloatArray) -> Postures:
        """Return the movement that a vector means, shape (v,)."""
        parts, count = np.split(vector, np.cumsum(self.sizes)[:-1]), self.recipe.postures
        postures = [np.clip(self._start + part @ self._of_posture, -1.0, 1.0) for part in parts[:count]]
        sway = [SWAY_STEP * part @ basis for part, basis in zip(parts[count:], self._of_sway, strict=True)]
        return Postures(
            task=self.task,
            age_months=self.age_months,
            joints=self.joints,
            postures=tuple(tuple(np.round(posture, 4).tolist()) for posture in postures),
            posture_s=self.recipe.posture_s,
            moving_s=self.recipe.moving_s,
            repeats=self.recipe.repeats,
            mirrored=self.recipe.is_mirrored,
            stiffness_per_rad=self.recipe.stiffness_per_rad,
            sway=tuple(tuple(np.round(row, 4).tolist()) for row in sway),
        )


def _name(joint: str) -> str:
    name = joint.removeprefix("robot:").removeprefix("left_").removeprefix("right_")
    return "fingers" if name.partition("_")[0] in FINGERS else name

"""Targets as an infant knows them: where they are, as soon as it has reacted to their being new there."""

import mujoco
import numpy as np

from mimoc.policies.behaviours.targets import Target
from mimoc.policies.reaction import Chance, Reaction
from mimoc.runtime.sense import FloatArray

JUMP_M = 0.05
"""Displacement from one control step to the next from which on a target counts as new there; less is followed."""


class NoticedTarget:
    """A target that is new where it appears, and wherever it jumps to."""

    def __init__(self, target: Target, reaction: Reaction[int] | None, chance: Chance):
        self.target, self._reaction, self._chance = target, reaction, chance
        self._number = 0
        self._seen_m: FloatArray | None = None
        self._known_m: FloatArray | None = None
        if reaction:
            reaction.begin()

    def watch(self, data: mujoco.MjData, time_s: float) -> None:
        """See where it is before a control step."""
        place_m = self.target.place_m(data).copy()
        if self._reaction is None:
            return
        is_new = self._seen_m is None or float(np.linalg.norm(place_m - self._seen_m)) > JUMP_M
        if is_new:
            if self._is_known(time_s):
                self._known_m = self._seen_m
            self._number += 1
            self._reaction.see(self._number, time_s, self._chance.drawn_from)
        self._seen_m = place_m

    def place_m(self, ahead: mujoco.MjData, time_s: float) -> FloatArray | None:
        """Return where it is as far as the infant has reacted to it, shape (3,); None before the first time."""
        return self.target.place_m(ahead) if self._is_known(time_s) else self._known_m

    def _is_known(self, time_s: float) -> bool:
        return self._reaction is None or (self._number > 0 and self._reaction.at(time_s) == self._number)

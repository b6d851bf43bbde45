"""Sound as it arrives at both ears."""

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.runtime.sense import FloatArray, Vector
from mimoc_nursery.sound.spec import SoundEntry

MAX_LEVEL_DB = 194.0
"""No undistorted sound is louder at atmospheric pressure."""
MIN_DISTANCE_M = 0.01
"""Nearer sources are as loud as at this distance."""
NUMBERS = ("left [dB]", "right [dB]", "x", "y", "z")
LOW, HIGH = (0.0, 0.0, -1.0, -1.0, -1.0), (MAX_LEVEL_DB, MAX_LEVEL_DB, 1.0, 1.0, 1.0)


class Sound(Vector):
    """For each source, the loudest first: level at the left and right ear [dB], unit vector to it in the head frame.

    If there are fewer toys than sources that can be heard, the rest is zero.
    """

    def __init__(self, entry: SoundEntry, model: mujoco.MjModel, toys: list[str]):
        """Find ears and toys in *model*."""
        count = entry.sources
        layout = [f"source {number}: {name}" for number in range(1, count + 1) for name in NUMBERS]
        super().__init__("sound", layout, np.tile(LOW, count), np.tile(HIGH, count))
        self._entry = entry
        self._ears = [model.site(entry.left_ear).id, model.site(entry.right_ear).id]
        self._head = model.body(entry.head).id
        self._toys = [model.body(toy).id for toy in toys]

    def __call__(self, data: mujoco.MjData) -> FloatArray:
        """Return the sample now, shape (5 k,) for k sources."""
        heard = np.zeros((self._entry.sources, len(NUMBERS)))
        if self._toys:
            levels_and_directions = self._of_toys(data)
            loudest = np.argsort(-levels_and_directions[:, :2].max(axis=1), kind="stable")[: len(heard)]
            heard[: len(loudest)] = levels_and_directions[loudest]
        return heard.ravel()

    def _of_toys(self, data: mujoco.MjData) -> FloatArray:
        """Return levels and directions of all toys, shape (n, 5)."""
        world_from_head = data.xmat[self._head].reshape(3, 3)
        positions_m = data.xipos[self._toys]
        offsets_m = positions_m - data.xipos[self._head]
        distances_m = np.linalg.norm(offsets_m, axis=1, keepdims=True).clip(MIN_DISTANCE_M)
        directions = offsets_m @ world_from_head / distances_m
        from_ears_m = np.linalg.norm(positions_m[:, None] - data.site_xpos[self._ears], axis=2).clip(MIN_DISTANCE_M)
        shadow_db = self._entry.head_shadow_db * np.stack([-directions[:, 1], directions[:, 1]], axis=1).clip(0.0)
        levels_db = self._entry.level_db - 20 * np.log10(from_ears_m) - shadow_db
        return np.hstack([levels_db.clip(0.0, MAX_LEVEL_DB), directions])


def bind(entry: SoundEntry, model: mujoco.MjModel, bundle: Bundle) -> Sound:
    """Find what *entry* names in *model*."""
    return Sound(entry, model, [toy.body for toy in bundle.manifest.toys])

"""Sound as it arrives at both ears."""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.senses.sense import FloatArray, IntArray, Vector
from mimoc_nursery.sound.spec import SoundEntry

MAX_LEVEL_DB = 194.0
"""No undistorted sound is louder at atmospheric pressure."""
NEAREST_M = 0.01
"""Sources nearer than that are as loud as there."""


@dataclass(frozen=True)
class Sound(Vector):
    """For each source, the loudest first: level at the left and right ear [dB], unit vector to it in the head frame.

    Where fewer toys are there than sources can be heard, the rest is zero.
    """

    entry: SoundEntry
    ears: IntArray
    """Sites of the left and the right ear, shape (2,)."""
    head: int
    sources: IntArray
    """Bodies that sound, shape (n,)."""
    layout: tuple[str, ...]

    def __call__(self, data: mujoco.MjData) -> FloatArray:
        """Return the sample now, shape (5 k,) for k sources."""
        heard = np.zeros((self.entry.sources, 5))
        if len(self.sources):
            found = self._heard(data)
            loudest = np.argsort(-found[:, :2].max(axis=1), kind="stable")[: self.entry.sources]
            heard[: len(loudest)] = found[loudest]
        return heard.ravel()

    def _heard(self, data: mujoco.MjData) -> FloatArray:
        """Return levels and directions of all sources, shape (n, 5)."""
        world_from_head = data.xmat[self.head].reshape(3, 3)
        places_m = data.xipos[self.sources]
        offsets_m = places_m - data.xipos[self.head]
        directions = offsets_m @ world_from_head / np.linalg.norm(offsets_m, axis=1, keepdims=True).clip(NEAREST_M)
        from_ears_m = places_m[:, None] - data.site_xpos[self.ears]
        distances_m = np.linalg.norm(from_ears_m, axis=2).clip(NEAREST_M)
        shadow_db = self.entry.head_shadow_db * np.stack([-directions[:, 1], directions[:, 1]], axis=1).clip(0.0)
        levels_db = self.entry.level_db - 20 * np.log10(distances_m) - shadow_db
        return np.hstack([levels_db.clip(0.0, MAX_LEVEL_DB), directions])


def bind(entry: SoundEntry, model: mujoco.MjModel, bundle: Bundle) -> Sound:
    """Find ears and toys in *model*."""
    names = ("left [dB]", "right [dB]", "x", "y", "z")
    count = entry.sources
    return Sound(
        name="sound",
        low=np.tile([0.0, 0.0, -1.0, -1.0, -1.0], count),
        high=np.tile([MAX_LEVEL_DB, MAX_LEVEL_DB, 1.0, 1.0, 1.0], count),
        bodies=np.full(5 * count, model.body(entry.head).id),
        entry=entry,
        ears=np.array([model.site(entry.left_ear).id, model.site(entry.right_ear).id]),
        head=model.body(entry.head).id,
        sources=np.array([model.body(toy.body).id for toy in bundle.manifest.toys], dtype=np.intp),
        layout=tuple(f"source {number}: {name}" for number in range(1, count + 1) for name in names),
    )

"""Parts of the skin that set off reflexes: the palm, the cheek, the sole, the ball and the back of the foot."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.policies.batch import Batch
from mimoc.runtime.sense import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Patch:
    """A box on one kind of body, of the right side; on the left, y is mirrored.

    Body frames: x of head and feet is forwards and z upwards; z of hands and fingers points to the tips, and -y of the
    right hand is where the palm is.
    """

    bodies: str
    inward: tuple[float, float, float]
    """Direction of what presses on it, in the frame of the body; for touch that is told by the sum on each body."""
    low: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """The corner with the least coordinates, as shares of the box around all skin points of the body."""
    high: tuple[float, float, float] = (1.0, 1.0, 1.0)
    """The opposite corner."""


AREAS: Mapping[str, tuple[Patch, ...]] = {
    "palm": (Patch("{side}_hand", (0, 1, 0), high=(1, 0.35, 1)),),
    "cheek": (Patch("head", (0, 1, 0), (0.55, 0.0, 0.05), (0.97, 0.35, 0.55)),),
    "sole": (Patch("{side}_(foot|toes|big_toe)", (0, 0, 1), high=(1, 1, 0.35)),),
    "ball": (
        Patch("{side}_foot", (0, 0, 1), (0.65, 0, 0), (1, 1, 0.35)),
        Patch("{side}_(toes|big_toe)", (0, 0, 1), high=(1, 1, 0.35)),
    ),
    "foot back": (Patch("{side}_(foot|toes|big_toe)", (0, 0, -1), low=(0, 0, 0.65)),),
}


class Area:
    """How hard something presses on one area of k infants, in [N]."""

    def __init__(self, batch: Batch, side: str, patches: tuple[Patch, ...], width: int, is_sum: bool):
        """Find the numbers of touch that belong to it, *width* a point; *is_sum* adds the forces on each body."""
        self._xp, self._width = batch.xp, width
        touches: list[Any] = [infant.senses["touch"] for infant in batch.infants]
        if is_sum:
            indices, weights = _bodies(touches[0].receptors, side, patches)
            self._directions = batch.put(weights[None]) if width == 3 and _is_in_body(batch) else None
            weights = np.ones((len(touches), len(indices)))
        else:
            inside = np.stack([_inside(touch.receptors, side, patches) for touch in touches])
            indices, self._directions = np.flatnonzero(inside.any(axis=0)), None
            weights = inside[:, indices].astype(np.float64)
        self._numbers = batch.put((indices[:, None] * width + np.arange(width)).ravel().astype(np.intp))
        self._weights, self._points = batch.put(weights), len(indices)

    def __call__(self, touch: Any) -> Any:
        """Return the force on it, shape (k,), of what is felt, shape (k, numbers)."""
        xp = self._xp
        forces = xp.reshape(xp.take(touch, self._numbers, axis=1), (touch.shape[0], self._points, self._width))
        if self._directions is not None:
            sizes = xp.maximum(xp.sum(forces * self._directions, axis=2), 0.0 * forces[:, :, 0])
        else:
            sizes = xp.sqrt(xp.sum(forces * forces, axis=2))
        return xp.sum(sizes * self._weights, axis=1)


def _inside(receptors: Any, side: str, patches: tuple[Patch, ...]) -> np.ndarray:
    """Return which points of one infant are in an area, shape (n,)."""
    inside = np.zeros(len(receptors.names), bool)
    for body in np.unique(receptors.names):
        is_on = receptors.names == body
        for patch in patches:
            if re.fullmatch(patch.bodies.format(side=side), body):
                places = receptors.points_m[is_on] * ([1, 1, 1] if side == "right" else [1, -1, 1])
                least = places.min(axis=0)
                shares = (places - least) / np.maximum(places.max(axis=0) - least, 1e-9)
                inside[is_on] |= ((shares >= patch.low) & (shares <= patch.high)).all(axis=1)
    return inside


def _bodies(receptors: Any, side: str, patches: tuple[Patch, ...]) -> tuple[IntArray, FloatArray]:
    """Return the bodies of an area, as numbers of those with skin, and where what presses points to, shape (m, 3)."""
    names = receptors.names[np.unique(receptors.bodies, return_index=True)[1]].tolist()
    chosen = [
        (number, np.array(patch.inward) * ([1, 1, 1] if side == "right" else [1, -1, 1]))
        for number, name in enumerate(names)
        for patch in patches
        if re.fullmatch(patch.bodies.format(side=side), name)
    ]
    numbers = np.array([number for number, _ in chosen], np.intp)
    return numbers, np.array([direction for _, direction in chosen], np.float64).reshape(-1, 3)


def _is_in_body(batch: Batch) -> bool:
    entry: Any = batch.infants[0].manifest.senses.touch
    return entry.quantity == "force_vector"

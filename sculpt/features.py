"""How full a body is at each age: heights above its solids, as smooth functions on the skin. Lengths are mm.

All are chosen by eye (D), on pictures of infants: rolls of fat come in the first months and go when a child walks.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from fields import Array

from mimoc.body.kinematics import Frame

AGES_MONTHS = (0.0, 3.0, 6.0, 12.0, 24.0)
Heights = tuple[float, float, float, float, float]  # At each of these ages.
ROLLS: Heights = (0.3, 1.0, 1.0, 0.75, 0.12)  # How deep the creases of a fat infant are.
SOFT_MM = 3.5
"""How much farther than the rest of the skin a belly may be in the floor that it lies on: it would give way."""


@dataclass(frozen=True)
class Dome:
    """A round height or hollow."""

    part: str
    place: tuple[float, float, float]  # Middle, in the frame of the body, right side.
    radii: tuple[float, float, float]  # Where it has fallen to 37 %, along the axes of that frame.
    heights: Heights


@dataclass(frozen=True)
class Ring:
    """A crease or a roll around a limb."""

    part: str
    end: tuple[float, float, float]  # Where the limb ends, in the frame of the body.
    at: float  # Place along it, as a share.
    width: float
    height: float  # At its fullest, of `ROLLS`.
    towards: tuple[float, float] = (0.0, 0.0)
    """To which side, x and y of the frame, it is deepest; its length, 0 to 1, is how much less it is opposite."""


ARM, FOREARM = (0.0, -4.0, 90.0), (0.0, -5.0, 79.0)
THIGH, SHANK = (2.0, 0.0, -112.0), (-1.0, 0.0, -141.0)
BELLY = Dome("hip", (62.0, 0.0, 78.0), (60.0, 62.0, 48.0), (1.5, 4.0, 7.5, 8.0, 4.0))
DOMES = (
    BELLY,
    Dome("hip", (10.0, -86.0, 66.0), (50.0, 30.0, 42.0), (0.0, 1.5, 3.5, 3.0, 0.0)),
    Dome("hip", (64.0, 0.0, 12.0), (40.0, 60.0, 9.0), (0.0, -1.0, -2.2, -2.2, -0.5)),
    Dome("hip", (74.0, 0.0, 58.0), (30.0, 5.5, 5.0), (1.0, -2.0, -3.8, -4.4, -3.8)),
    Dome("chest", (60.0, 0.0, -50.0), (50.0, 60.0, 30.0), (-1.0, -0.5, -0.5, -1.0, -1.5)),
    Dome("hip", (-45.0, -32.0, -12.0), (30.0, 24.0, 26.0), (-1.0, 1.5, 2.5, 2.5, 0.5)),
    Dome("head", (-6.0, 0.0, -8.0), (60.0, 60.0, 6.0), (-1.0, -2.5, -2.2, -1.2, 0.0)),
    Dome("chest", (-14.0, -46.0, 20.0), (24.0, 24.0, 16.0), (4.5, 5.5, 5.5, 5.0, 4.0)),
    Dome("right_upper_arm", (0.0, 6.0, -14.0), (24.0, 24.0, 15.0), (-3.0, -3.0, -3.0, -3.0, -3.0)),
    Dome("right_upper_arm", (0.0, -4.0, 40.0), (40.0, 40.0, 34.0), (-0.8, 1.2, 1.5, 0.8, -1.0)),
    Dome("right_lower_arm", (0.0, -2.0, 28.0), (40.0, 40.0, 26.0), (-1.0, 1.4, 1.8, 1.0, -1.0)),
    Dome("right_upper_leg", (0.0, 0.0, -50.0), (60.0, 60.0, 50.0), (-1.6, 1.4, 1.8, 0.6, -1.6)),
    Dome("right_lower_leg", (-16.0, 0.0, -42.0), (30.0, 40.0, 36.0), (-1.0, 1.6, 2.2, 1.6, 0.4)),
    Dome("right_foot", (20.0, 0.0, 12.0), (26.0, 20.0, 14.0), (-0.3, 1.6, 2.0, 1.6, 0.0)),
    Dome("right_hand", (2.0, 10.0, 14.0), (18.0, 9.0, 16.0), (-0.4, 1.0, 1.4, 1.2, 0.0)),
    Dome("right_hand", (2.0, -10.0, 14.0), (18.0, 9.0, 16.0), (-0.4, 1.0, 1.4, 1.2, 0.0)),
)
RINGS = (
    Ring("right_lower_arm", FOREARM, 0.96, 4.2, -3.2),
    Ring("right_lower_arm", FOREARM, 0.76, 9.0, 2.0),
    Ring("right_upper_leg", THIGH, 0.37, 5.5, -3.6, (0.4, 0.8)),
    Ring("right_upper_leg", THIGH, 0.50, 9.0, 2.2, (0.3, 0.8)),
    Ring("right_upper_leg", THIGH, 0.64, 5.5, -2.8, (0.3, 0.9)),
    Ring("right_upper_leg", THIGH, 0.80, 10.0, 1.2, (0.3, 0.7)),
    Ring("right_upper_leg", THIGH, 0.20, 7.0, -2.2, (-0.9, 0.0)),
    Ring("right_lower_leg", SHANK, 0.91, 5.5, -2.4, (0.3, 0.0)),
    Ring("right_lower_leg", SHANK, 0.76, 11.0, 1.6),
    Ring("right_upper_arm", ARM, 0.98, 6.0, -1.6, (0.5, 0.0)),
)
FINE = (("right_lower_arm", (0.0, -5.0, 75.0), 14.0, 5.6), ("hip", (72.0, 0.0, 58.0), 13.0, 4.2))
"""Where the mesh is finer, lest creases be lost: body, place, how far around it, and the length of edges."""
KNUCKLES: Mapping[str, Sequence[tuple[str, tuple[float, float, float]]]] = {
    "mitten": [("right_hand", (x, 9.0, 34.0)) for x in (15.0, 5.0, -5.0, -14.5)],
    "five_finger": [(f"right_{name}knuckle", (0.0, 6.0, 0.0)) for name in ("ff", "mf", "rf", "lf")],
}
"""Backs of the hands' knuckles, which are dimples in a fat infant."""


def arrays(
    verts: Array, held: Array, parts: Sequence[str], frames: Mapping[str, Frame], hands: str
) -> dict[str, np.ndarray]:
    """Return what ships of fullness."""
    heights = sum(_heights(verts, held, parts, frames, feature) for feature in (*DOMES, *RINGS, *_dimples(hands)))
    return {
        "ages_months": np.array(AGES_MONTHS),
        "fullness_100um": np.rint(10 * heights).clip(-127, 127).astype(np.int8),
    }


def softness(verts: Array, frames: Mapping[str, Frame]) -> Array:
    """Return how much farther than other skin each vertex may be in the floor, [mm]."""
    return SOFT_MM * _dome(BELLY, _local(verts, frames[BELLY.part]))


def _dimples(hands: str) -> list[Dome]:
    depths = (-0.3, -1.0, -1.2, -1.2, -0.3)
    return [Dome(part, place, (2.4, 4.0, 2.4), depths) for part, place in KNUCKLES[hands]]


def _heights(
    verts: Array, held: Array, parts: Sequence[str], frames: Mapping[str, Frame], feature: Dome | Ring
) -> Array:
    """Return how high a feature is at each age, shape (ages, n)."""
    points = _local(verts, frames[feature.part])
    if isinstance(feature, Ring):
        shape, heights = _ring(feature, points), feature.height * np.array(ROLLS)
    else:
        shape, heights = _dome(feature, points), np.array(feature.heights)
    return heights[:, None] * (shape * _share(held, parts, feature.part))


def _share(held: Array, parts: Sequence[str], part: str) -> Array:
    """Return whether vertices are of a limb, blended; of the trunk all are that are of no limb."""
    if part.startswith("right"):
        mine = [part, part.replace("right", "left")]
        return np.clip(2 * held[:, [parts.index(name) for name in mine]].sum(axis=1), 0, 1)
    limbs = [index for index, name in enumerate(parts) if name.startswith(("left", "right"))]
    return 1 - np.clip(1.4 * held[:, limbs].sum(axis=1) - 0.2, 0, 1)


def _local(verts: Array, frame: Frame) -> Array:
    """Return points, folded to the right side, in the frame of a body."""
    return (verts * (1, -1, 1) * (verts[:, 1:2] > 0) + verts * (verts[:, 1:2] <= 0) - frame[0] * 1000) @ frame[1]


def _dome(dome: Dome, points: Array) -> Array:
    return np.exp(-(((points - dome.place) / dome.radii) ** 2).sum(axis=1))


def _ring(ring: Ring, points: Array) -> Array:
    along = np.array(ring.end)
    t = points @ along / (along @ along)
    across = points - t[:, None] * along
    across = across[:, :2] / np.maximum(np.linalg.norm(across[:, :2], axis=1, keepdims=True), 1e-6)
    most = float(np.hypot(*ring.towards))
    side = 1 - most / 2 + across @ np.array(ring.towards) / 2
    return side * np.exp(-(((t - ring.at) * np.linalg.norm(along) / ring.width) ** 2))


def finer(frames: Mapping[str, Frame]) -> Callable[[Array, Array], Array]:
    """Return a function of points and lengths of edges that makes these shorter where there are fine features."""

    def fined(points: Array, sizes: Array) -> Array:
        for part, place, radius, size in FINE:
            near = np.exp(-((np.linalg.norm(_local(points, frames[part]) - place, axis=1) / radius) ** 4))
            sizes = sizes + near * np.minimum(size - sizes, 0)
        return sizes

    return fined

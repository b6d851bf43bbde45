"""The skin of an infant: where its points are, and which of them feel what touches it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

from mimoc.senses.sense import FloatArray, IntArray

REACH = 2.0
"""How far a touch is felt, in spacings of the skin's points."""
APART = np.array([1e3, 0.0, 0.0])
"""Where each body is beyond the one before, in reaches: they do not meet."""
STRIDES = np.array([1e8, 1e4, 1.0])
"""What makes one number of the corner of a cell."""


@dataclass(frozen=True)
class Skin:
    """The n points of a skin, and which are near to what, in a space where all bodies are far apart.

    Its unit is the reach of the body. It is cut into cells, cubes of one unit.
    """

    names: npt.NDArray[np.str_]
    """The body of each point, shape (n,)."""
    bodies: IntArray
    """The same, as the model's ids, shape (n,)."""
    points_m: FloatArray
    """Shape (n, 3), in the frames of their bodies."""
    per_m: FloatArray
    """Units in a metre, by body of the model, shape (nbody, 1)."""
    shifts: FloatArray
    """Where the frames of the bodies are, shape (nbody, 3)."""
    spots: FloatArray
    """Where the points are, shape (3, n + 1); the last, which fills tables, is infinitely far."""
    cells: FloatArray
    """The cells that have points within reach, shape (c,), sorted."""
    neighbours: IntArray
    """The points within reach of any place in a cell, then n, shape (c + 1, k); past the last cell there are none."""
    tree: KDTree
    """The points, for a search without limits."""

    def around(self, bodies: IntArray, places_m: FloatArray, felt: FloatArray) -> tuple[IntArray, FloatArray]:
        """Share what is felt among the points around: return the points (m, k), and what each feels (width, m, k).

        The share falls linearly with the distance, to 0 at the reach. What is out of reach of all is felt by the
        nearest. The shares sum to what there is to feel.

        Args:
            bodies: What is touched, shape (m,).
            places_m: Where, shape (m, 3), in the frames of the bodies.
            felt: What there is to feel, shape (m, width).
        """
        spots = places_m * self.per_m.take(bodies, 0) + self.shifts.take(bodies, 0)
        cells = self.cells.searchsorted(_cells(spots))  # What is near to a wrong one is out of reach.
        points = self.neighbours.take(cells, 0)
        away = self.spots.take(points, 1) - spots.T[:, :, None]
        weights = np.maximum(1.0 - np.sqrt(np.add.reduce(away * away)), 0.0)
        sums = np.add.reduce(weights, 1)
        if 0.0 in sums.tolist():
            alone = sums == 0.0
            points[alone, 0], weights[alone, 0], sums[alone] = self.tree.query(spots[alone])[1], 1.0, 1.0
        return points, (felt.T / sums)[:, :, None] * weights

    def nearest(self, bodies: IntArray, places_m: FloatArray, felt: FloatArray) -> tuple[IntArray, FloatArray]:
        """Give what is felt to the nearest points: return these (m, 1), and what each feels (width, m, 1)."""
        _, points = self.tree.query(places_m * self.per_m[bodies] + self.shifts[bodies])
        return points[:, None], felt.T[:, :, None]


def bind_skin(
    by_body_m: Mapping[str, Sequence[Sequence[float]]], spacing_m: Mapping[str, float], model: mujoco.MjModel
) -> Skin:
    """Return the skin of some bodies: body by body, in the order of the model.

    Args:
        by_body_m: The points of each, in its frame.
        spacing_m: Distance of neighbouring points by body.
        model: What the bodies belong to.
    """
    parts = sorted((model.body(name).id, name, np.array(points)) for name, points in by_body_m.items() if points)
    names = np.repeat([name for _, name, _ in parts], [len(points) for *_, points in parts])
    names.flags.writeable = False
    points_m = np.concatenate([points for *_, points in parts])
    known, indices = np.unique(names, return_inverse=True)
    ids = np.array([model.body(name).id for name in known])
    bodies = ids[indices]
    per_m = np.zeros((model.nbody, 1))
    per_m[ids, 0] = [1 / (REACH * spacing_m[name]) for name in known]
    shifts = np.arange(model.nbody)[:, None] * APART
    spots = points_m * per_m[bodies] + shifts[bodies]
    cells, neighbours = _neighbours(spots)
    ended = np.ascontiguousarray(np.vstack([spots, np.full(3, np.inf)]).T)
    return Skin(names, bodies, points_m, per_m, shifts, ended, cells, neighbours, KDTree(spots))


def _neighbours(spots: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the cells that have points within reach, and a table of these."""
    around = np.stack(np.meshgrid(*[[-1.0, 0.0, 1.0]] * 3), axis=-1).reshape(-1, 3)
    corners = np.floor(spots)[:, None] + around
    gaps = np.maximum(np.maximum(corners - spots[:, None], spots[:, None] - corners - 1.0), 0.0)
    points, column = np.nonzero(np.sum(gaps * gaps, axis=2) < 1.0)
    cells, rows, counts = np.unique(_cells(corners[points, column]), return_inverse=True, return_counts=True)
    order = np.argsort(rows, kind="stable")
    table = np.full((len(cells) + 1, counts.max()), len(spots))
    table[rows[order], np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)] = points[order]
    return cells, table


def _cells(spots: FloatArray) -> FloatArray:
    """Return the cells that places are in."""
    return np.floor(spots) @ STRIDES

"""Where a body comes to rest on the ground as it rolls about y, in several poses at once."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.body.kinematics import FloatArray, centres_of_mass, pose_all
from mimoc.body.tree import BodyTree
from mimoc.geometry.primitives import Extents, extents
from mimoc.geometry.solvers import narrowed
from mimoc.units import deg_to_rad

_STEP_RAD = deg_to_rad(0.5)
"""Step of pitch in the search for the resting pitch."""
_STEPS = 16
"""Number of steps that are tried at once."""
_NEAR_M_PER_RAD = 6.0
"""A geom that is so much higher than the lowest does not become it: no part of an infant is farther than 1.5 m from
another, so each falls and rises by less than half of this."""
_PRECISION_RAD = 1e-9


@dataclass(frozen=True, slots=True)
class Rollers:
    """The k geoms with which a body touches the ground in each of p poses, in the frame of its hip."""

    centres: FloatArray
    """Shape (p, k, 3), [m]."""
    rotations: FloatArray
    """Hip from geom, shape (p, k, 3, 3)."""
    half_edges: FloatArray
    """Of the boxes that make up `Extents`, shape (p, k, 3), [m]."""
    half_axes: FloatArray
    """Of the ellipsoids, likewise."""
    centres_of_mass: FloatArray
    """Of the whole body, shape (p, 3), [m]."""

    def rest(self, pitches_rad: FloatArray) -> list[tuple[float, float]]:
        """Return the pitch at which the body comes to rest in each pose, and the height of its hip there, in [m].

        It rolls downhill to the next minimum of the height of its centre of mass, as if it were rigid.

        Args:
            pitches_rad: Where it starts, shape (p,).
        """
        lowest, touching = self._downhill(pitches_rad), self
        lows, highs = lowest - _STEP_RAD, lowest + _STEP_RAD
        for width_rad in (_STEP_RAD, _PRECISION_RAD):
            touching = touching._lowest(lows, highs)
            lows, highs = narrowed(touching._heights, lows, highs, width_rad)
        found = [round(pitch, 6) for pitch in ((lows + highs) / 2).tolist()]  # Further digits are noise.
        return [(pitch, self._height(index, pitch)) for index, pitch in enumerate(found)]

    def _downhill(self, pitches_rad: FloatArray) -> FloatArray:
        """Return the last pitch in steps from where each pose starts, before it goes uphill, shape (p,)."""
        behind, ahead = self._heights(pitches_rad[:, None] + (-_STEP_RAD, _STEP_RAD)).T
        steps_rad = np.where(behind < ahead, -_STEP_RAD, _STEP_RAD)[:, None]
        paths_rad = pitches_rad[:, None] + steps_rad * np.arange(_STEPS + 1)
        while True:
            rising = np.diff(self._heights(paths_rad), axis=1) >= 0
            onwards = ~rising.any(axis=1)
            if not onwards.any():
                return paths_rad[np.arange(len(paths_rad)), rising.argmax(axis=1)]
            paths_rad[onwards] += paths_rad[onwards, -1:] - paths_rad[onwards, :1]

    def _heights(self, pitches_rad: FloatArray) -> FloatArray:
        """Return the height of the centre of mass above the ground at m pitches of each pose, shape (p, m), [m]."""
        downs = _downs(pitches_rad)
        return self._depths(downs).max(axis=2) - (downs @ self.centres_of_mass[:, :, None])[:, :, 0]

    def _depths(self, downs: FloatArray) -> FloatArray:
        """Return how far each geom reaches from the hip along m directions, shape (p, m, 3), as (p, m, k), [m]."""
        local = np.swapaxes(downs[:, None] @ self.rotations, 1, 2)
        of_geoms = Extents(self.half_edges[:, None], self.half_axes[:, None]).along(local)
        return downs @ np.swapaxes(self.centres, 1, 2) + of_geoms

    def _lowest(self, lows_rad: FloatArray, highs_rad: FloatArray) -> "Rollers":
        """Return this with only the geoms that can be the lowest at pitches within brackets, shapes (p,)."""
        middles_rad, halves_rad = (lows_rad + highs_rad) / 2, (highs_rad - lows_rad) / 2
        depths_m = self._depths(_downs(middles_rad[:, None]))[:, 0]
        near = depths_m > (depths_m.max(axis=1) - _NEAR_M_PER_RAD * halves_rad)[:, None]
        kept = np.argsort(~near, axis=1)[:, : near.sum(axis=1).max()]
        poses = np.arange(len(kept))[:, None]
        return Rollers(
            self.centres[poses, kept],
            self.rotations[poses, kept],
            self.half_edges[poses, kept],
            self.half_axes[poses, kept],
            self.centres_of_mass,
        )

    def _height(self, pose: int, pitch_rad: float) -> float:
        """Return the height of the hip above the ground, in [m]."""
        (down,) = _downs(np.array([pitch_rad]))
        local = np.einsum("nij,i->nj", self.rotations[pose], down)
        depths_m = Extents(self.half_edges[pose], self.half_axes[pose]).along(local)
        return float((self.centres[pose] @ down + depths_m).max())


def rollers(tree: BodyTree, poses_rad: Sequence[Mapping[str, float]]) -> Rollers:
    """Return the geoms of a body that can touch the ground, in some poses, given as angles by joint."""
    geoms, centres, rotations = pose_all(tree, poses_rad)
    solid = [index for index, geom in enumerate(geoms) if geom.contype or geom.conaffinity]
    reach = extents((geoms[index].type, geoms[index].size_m) for index in solid)
    edges, axes = (np.repeat(array[None], len(poses_rad), axis=0) for array in (reach.half_edges, reach.half_axes))
    return Rollers(centres[:, solid], rotations[:, solid], edges, axes, centres_of_mass(geoms, centres))


def _downs(pitches_rad: FloatArray) -> FloatArray:
    """Return the directions of gravity in the frame of a hip that is rotated about y, shape (..., 3)."""
    downs = np.zeros((*pitches_rad.shape, 3))
    downs[..., 0], downs[..., 2] = np.sin(pitches_rad), -np.cos(pitches_rad)
    return downs

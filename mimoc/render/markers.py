"""Markers: small spheres drawn on top of an infant, such as one on each point of its skin."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.rotations import FloatArray

RADIUS_IN_SPACINGS = 0.16
"""Radius of a marker, as a share of the spacing of the skin."""
MAX_RADIUS_M = 0.0025
"""Or those of trunk and legs would hide what they are on."""
ENLARGEMENT = 1.6
"""How much larger the markers of points under force are."""
UNLOADED = (0.05, 0.2, 0.75, 1.0)
LEAST, MOST = (1.0, 0.85, 0.1, 1.0), (0.85, 0.0, 0.1, 1.0)
"""Colours of points under no force, under the least and under the largest, as red, green, blue and opacity."""


@dataclass(frozen=True, slots=True)
class Markers:
    """Some n spheres to draw."""

    positions_m: FloatArray
    """Shape (n, 3), in the world."""
    radii_m: FloatArray
    """Shape (n,)."""
    colours: npt.NDArray[np.float32]
    """Red, green, blue and opacity, shape (n, 4)."""

    def moved(self, move: Callable[[FloatArray], FloatArray]) -> "Markers":
        """Return them where a motion of points, shape (n, 3), takes them."""
        return Markers(move(self.positions_m), self.radii_m, self.colours)


def force_markers(positions_m: FloatArray, forces_n: FloatArray, spacings_m: FloatArray) -> Markers:
    """Return a marker for each of n points of a skin in the world, shape (n, 3), in the colour of the force on it.

    Magnitudes of forces, and distances of points from their neighbours, have the shape (n,).
    """
    radii_m = np.minimum(RADIUS_IN_SPACINGS * spacings_m, MAX_RADIUS_M)
    share = (forces_n / max(forces_n.max(), 1e-12))[:, None]  # The scale of colours ends with the largest force.
    colours = np.where(share > 0, np.array(LEAST) + share * np.subtract(MOST, LEAST), UNLOADED).astype(np.float32)
    return Markers(positions_m, np.where(forces_n > 0, ENLARGEMENT, 1) * radii_m, colours)


def join_markers(parts: Iterable[Markers]) -> Markers:
    """Return all markers of several."""
    columns = zip(*((part.positions_m, part.radii_m, part.colours) for part in parts), strict=True)
    return Markers(*map(np.concatenate, columns))


def add_markers(scene: mujoco.MjvScene, markers: Markers) -> None:
    """Add markers to a scene that has room for them."""
    upright = np.eye(3).ravel()
    for position, radius_m, colour in zip(markers.positions_m, markers.radii_m, markers.colours, strict=True):
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(geom, mujoco.mjtGeom.mjGEOM_SPHERE, np.full(3, radius_m), position, upright, colour)
        scene.ngeom += 1

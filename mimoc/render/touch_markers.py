"""Small balls drawn on top of an infant: one on each point of its skin."""

from collections.abc import Iterable
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.io import Bundle
from mimoc.errors import RenderingError
from mimoc.senses.binding import bind_sense

FloatArray = npt.NDArray[np.float64]

SIZE = 0.16
"""Radius of a ball, in spacings of the skin."""
MAX_RADIUS_M = 0.0025
"""Or those of trunk and legs would hide what they are on."""
SWELLING = 1.6
"""How much larger those are that feel something."""
RESTING = (0.05, 0.2, 0.75, 1.0)
LEAST, MOST = (1.0, 0.85, 0.1, 1.0), (0.85, 0.0, 0.1, 1.0)
"""Colours of points that feel nothing, least and most, as red, green, blue and opacity."""


@dataclass(frozen=True, slots=True)
class Beads:
    """Some n balls to draw."""

    positions: FloatArray
    """Shape (n, 3), in the world, [m]."""
    radii_m: FloatArray
    """Shape (n,)."""
    colours: npt.NDArray[np.float32]
    """Red, green, blue and opacity, shape (n, 4)."""


def skin_beads(bundle: Bundle, model: mujoco.MjModel, data: mujoco.MjData) -> Beads:
    """Return a ball for each point of an infant's skin, in the colour of what it feels.

    Raises:
        RenderingError: If the infant has no sense of touch.
    """
    entry = bundle.manifest.senses.touch
    if entry is None:
        raise RenderingError(
            f"'{bundle.manifest.name}' has no sense of touch, so no skin to show; "
            "add `senses: {touch: {}}` to its spec, and build it again"
        )
    state = bind_sense("touch", bundle, model).skin_state(data)
    forces_n = np.linalg.norm(state.forces, axis=1)
    radii_m = np.minimum(SIZE * np.array([entry.spacing_m[body] for body in state.bodies]), MAX_RADIUS_M)
    return Beads(state.positions, np.where(forces_n > 0, SWELLING, 1) * radii_m, _colours(forces_n))


def join_beads(parts: Iterable[Beads]) -> Beads:
    """Return all balls of several."""
    columns = zip(*((part.positions, part.radii_m, part.colours) for part in parts), strict=True)
    return Beads(*map(np.concatenate, columns))


def scene_for(beads: Beads, model: mujoco.MjModel, other_geoms: int) -> mujoco.MjvScene:
    """Return a scene with room for beads and other geoms, and no shadows: those of the beads would hide the skin."""
    scene = mujoco.MjvScene(model, other_geoms + len(beads.radii_m))
    scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW] = False
    return scene


def add_beads(scene: mujoco.MjvScene, beads: Beads) -> None:
    """Add balls to a scene that has room for them."""
    upright = np.eye(3).ravel()
    for position, radius_m, colour in zip(beads.positions, beads.radii_m, beads.colours, strict=True):
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(geom, mujoco.mjtGeom.mjGEOM_SPHERE, np.full(3, radius_m), position, upright, colour)
        scene.ngeom += 1


def _colours(forces_n: FloatArray) -> npt.NDArray[np.float32]:
    """Return colours by force, on a scale that the largest one ends."""
    share = (forces_n / max(forces_n.max(), 1e-12))[:, None]
    felt = np.array(LEAST) + share * np.subtract(MOST, LEAST)
    return np.where(share > 0, felt, RESTING).astype(np.float32)

"""The primitives of a compiled model, and how far they reach."""

from collections.abc import Mapping

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.primitives import Extents, Kind, extents

PRIMITIVES: Mapping[int, Kind] = {
    int(mujoco.mjtGeom.mjGEOM_SPHERE): "sphere",
    int(mujoco.mjtGeom.mjGEOM_ELLIPSOID): "ellipsoid",
    int(mujoco.mjtGeom.mjGEOM_CAPSULE): "capsule",
    int(mujoco.mjtGeom.mjGEOM_CYLINDER): "cylinder",
    int(mujoco.mjtGeom.mjGEOM_BOX): "box",
}
"""Kinds of primitives by MuJoCo's geom type."""


def solid_extents(model: mujoco.MjModel, geoms: npt.NDArray[np.intp]) -> Extents:
    """Return how far some geoms reach from their centres, from their indices, shape (n,)."""
    return extents((PRIMITIVES[model.geom_type[geom]], model.geom_size[geom]) for geom in geoms)

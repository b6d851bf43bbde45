"""How far solids reach: as spheres and corners that they lie between, and downwards."""

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.render.camera import Spheres

CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
ENDS = np.array([(0, 0, -1), (0, 0, 1)], float)
SPHERE, CAPSULE = mujoco.mjtGeom.mjGEOM_SPHERE, mujoco.mjtGeom.mjGEOM_CAPSULE
ELLIPSOID, CYLINDER = mujoco.mjtGeom.mjGEOM_ELLIPSOID, mujoco.mjtGeom.mjGEOM_CYLINDER


def tight_spheres(model: mujoco.MjModel, data: mujoco.MjData, geoms: npt.NDArray[np.bool_]) -> Spheres:
    """Return spheres that some geoms, shape (ngeom,), lie between.

    They are a sphere itself, the ends of a capsule, and the corners of the box around anything else.
    """
    parts = [_of_geom(model, data, number) for number in np.flatnonzero(geoms).tolist()]
    if not parts:
        return Spheres(np.empty((0, 3)), np.empty(0))
    return Spheres(np.concatenate([part.centres_m for part in parts]), np.concatenate([part.radii_m for part in parts]))


def _of_geom(model: mujoco.MjModel, data: mujoco.MjData, number: int) -> Spheres:
    kind, size_m = model.geom_type[number], model.geom_size[number]
    if kind == SPHERE:
        local_m, radius_m = np.zeros((1, 3)), size_m[0]
    elif kind == CAPSULE:
        local_m, radius_m = ENDS * size_m[1], size_m[0]
    else:
        local_m, radius_m = model.geom_aabb[number, :3] + CORNERS * model.geom_aabb[number, 3:], 0.0
    centres_m = data.geom_xpos[number] + local_m @ data.geom_xmat[number].reshape(3, 3).T
    return Spheres(centres_m, np.full(len(centres_m), radius_m))


def lowest_m(model: mujoco.MjModel, data: mujoco.MjData, geoms: npt.NDArray[np.bool_]) -> float:
    """Return the height of the lowest point of some geoms, shape (ngeom,)."""
    return min(
        float(data.geom_xpos[number, 2]) - _drop_m(model, data, number) for number in np.flatnonzero(geoms).tolist()
    )


def _drop_m(model: mujoco.MjModel, data: mujoco.MjData, number: int) -> float:
    """Return how far a geom reaches below its origin: the support function of its kind for straight down."""
    down = data.geom_xmat[number].reshape(3, 3)[2]  # Of its axes; the sign does not matter, but for meshes.
    kind, (first, second, _) = model.geom_type[number], model.geom_size[number]
    if kind == SPHERE:
        return float(first)
    if kind == CAPSULE:
        return float(first + second * abs(down[2]))
    if kind == ELLIPSOID:
        return float(np.linalg.norm(model.geom_size[number] * down))
    if kind == CYLINDER:
        return float(first * np.hypot(down[0], down[1]) + second * abs(down[2]))
    return float((np.abs(down) * model.geom_aabb[number, 3:]).sum() - down @ model.geom_aabb[number, :3])

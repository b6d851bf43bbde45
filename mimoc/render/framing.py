"""Where the camera of a portrait stands: by how an infant is turned, and as near as what is drawn of it allows."""

from collections.abc import Sequence

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.rotations import FloatArray
from mimoc.bundle.model import in_subtrees
from mimoc.render.camera import FROM_THE_SIDE, Spheres, View, view_of_body
from mimoc.render.renderer import Shown

FILLED = 0.78
"""Share of a portrait's height or width that an infant takes."""
FILLED_BY_HEAD = 0.84
"""Of that of a head alone."""
FACE_ASIDE, FACE_AHEAD, LOW_DEG = 128.0, 147.0, -18.0
"""Azimuths and elevation of the view of an infant on its belly or on all fours, from beyond its head and to its right,
if its face lies to a side, and if it looks ahead (D)."""
ABOVE_DEG = -78.0
"""Elevation of the view of an infant on its back, which shows its face and not its chin (D)."""
FACE_TO_FACE: View = (-20.0, -6.0)
"""View of a head: how far it is turned from the camera, and the camera's elevation if it is upright (D)."""
SIDEWAYS = 0.35
"""Of the direction of a face along an infant's left, from which on it looks to a side."""
VERTICAL = 0.75
"""Of the direction of a face along the vertical, from which on it looks up or down."""
STEEP_DEG, LEVEL_DEG = 75.0, 4.0
"""Elevation of a camera above a face that looks up, and the least above any face."""


def portrait_view(data: mujoco.MjData, root: str, head: str | None) -> View:
    """Return the direction that shows an infant best: from its front, or from above where it lies on its back.

    One that lies on its face is seen from where it looks, and not from far above.
    """
    lying = float(_axis(data, root, 0)[2])  # 1 on its back, -1 on its face.
    if lying > -0.5:
        azimuth, elevation = view_of_body(FROM_THE_SIDE, data, root)
        return azimuth, min(elevation, ABOVE_DEG) if lying > 0.5 else elevation
    aside = 0.0 if head is None else float(_axis(data, head, 0) @ _axis(data, root, 1))
    azimuth = FACE_ASIDE if abs(aside) > SIDEWAYS else FACE_AHEAD
    usual, _ = view_of_body((360.0 - azimuth if aside > SIDEWAYS else azimuth, 0.0), data, root)
    return usual, LOW_DEG


def view_of_head(data: mujoco.MjData, head: str) -> View:
    """Return the direction that shows a head from before it, a little to its right and above."""
    ahead, crown = _axis(data, head, 0), _axis(data, head, 2)
    turned_deg, elevation = FACE_TO_FACE
    if ahead[2] > VERTICAL:
        return _azimuth_deg(crown) + turned_deg, -STEEP_DEG
    if ahead[2] < -VERTICAL:  # From before its crown, as low as can be.
        return _azimuth_deg(-crown) + turned_deg, -LEVEL_DEG
    level_deg = float(np.degrees(np.arcsin(np.clip(ahead[2], -1, 1))))
    return _azimuth_deg(-ahead) + turned_deg, min(elevation - level_deg, -LEVEL_DEG)


def _axis(data: mujoco.MjData, body: str, axis: int) -> FloatArray:
    return data.body(body).xmat.reshape(3, 3)[:, axis]


def _azimuth_deg(vector: FloatArray) -> float:
    return float(np.degrees(np.arctan2(vector[1], vector[0])))


def drawn_spheres(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    scene: mujoco.MjvScene,
    bodies: Sequence[str],
    drawn: npt.NDArray[np.bool_],
    shown: Shown,
) -> Spheres:
    """Return what is drawn of some bodies, and of those that hang on them, as spheres, some of no size."""
    held = in_subtrees(model, [model.body(body).id for body in bodies])
    vertices_m = np.reshape(scene.skinvert, (-1, 3))
    skins = [
        vertices_m[scene.skinvertadr[number] : scene.skinvertadr[number] + scene.skinvertnum[number]]
        for number in range(scene.nskin)
        if shown == "skin" and held[_bones(model, number)].all()
    ]
    geoms = held[model.geom_bodyid]
    solids = tight_spheres(model, data, geoms & drawn if skins else geoms)
    points_m = np.concatenate([solids.centres_m, *skins])
    return Spheres(points_m, np.concatenate([solids.radii_m, np.zeros(len(points_m) - len(solids.radii_m))]))


def _bones(model: mujoco.MjModel, skin: int) -> npt.NDArray[np.int32]:
    start, count = model.skin_boneadr[skin], model.skin_bonenum[skin]
    return model.skin_bonebodyid[start : start + count]


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

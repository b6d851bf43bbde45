"""Heights of points above solids, and the directions away from them."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import GeometryError
from mimoc.base.geometry.rotations import FloatArray
from mimoc.body.kinematics import Posed
from mimoc.body.tree import Geom

IntArray = npt.NDArray[np.intp]
LEAST_SLOPE = 0.3  # Smallest square of a blended slope that is divided by: between two fingers, the slopes cancel.


def surface_distance(
    posed: Posed, solids: Sequence[str], near: IntArray, blend_m: FloatArray, points: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the height of points above the solids near them, blended, and its slope.

    Args:
        posed: The body.
        solids: Names of solids; those that the body does not have are left out.
        near: Indices of the solids near each point, shape (n, k).
        blend_m: Width of the blend at each point, shape (n,).
        points: Shape (n, 3), in the frame of the hip.

    Returns:
        Heights, shape (n,), and slopes, shape (n, 3); those of a point near which nothing is left are 0.

    Raises:
        GeometryError: If the body has none of these solids.
    """
    number = {geom.name: index for index, geom in enumerate(posed.geoms)}
    if number.keys().isdisjoint(solids):
        raise GeometryError(f"skin: the body has no solid that is called as one of the skin's, such as '{solids[0]}'")
    owner = np.array([number.get(name, -1) for name in solids])[near.ravel()]
    turns, sizes = np.array(posed.rotations)[owner], np.array([_three(geom) for geom in posed.geoms])[owner]
    from_centres = np.repeat(points, near.shape[1], axis=0) - np.array(posed.centres)[owner]
    local = np.einsum("ni,nij->nj", from_centres, turns)
    far, away = np.full(len(owner), np.inf), np.zeros((len(owner), 3))
    for kind in {geom.type for geom in posed.geoms}:
        alike = np.array([*(geom.type == kind for geom in posed.geoms), False])  # The last one is of those left out.
        of_kind = np.flatnonzero(alike[owner])
        far[of_kind], away[of_kind] = height_above(kind, sizes[of_kind], local[of_kind])
    away = np.einsum("nij,nj->ni", turns, away)
    return _blended(far.reshape(near.shape), away.reshape(*near.shape, 3), blend_m)


def _three(geom: Geom) -> tuple[float, float, float]:
    first, second, third, *_ = (*geom.size_m, 0.0, 0.0)
    return first, second, third


def height_above(kind: str, sizes: FloatArray, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the heights of points above solids of one type and the directions away from them, (n,) and (n, 3).

    Args:
        kind: The type of the geoms.
        sizes: Those of the solid of each point, as MuJoCo has them, shape (n, 3).
        points: Each in the frame of its solid, shape (n, 3).
    """
    if kind in ("sphere", "capsule"):
        axis = points.copy()
        if kind == "capsule":
            axis[:, 2] -= np.clip(points[:, 2], -sizes[:, 1], sizes[:, 1])
        far = np.linalg.norm(axis, axis=1)
        return far - sizes[:, 0], axis / np.maximum(far, 1e-9)[:, None]
    if kind == "ellipsoid":
        inner = np.linalg.norm(points / sizes, axis=1)
        slope = points / sizes**2
        steep = np.maximum(np.linalg.norm(slope, axis=1), 1e-9)
        return inner * (inner - 1) / steep, slope / steep[:, None]
    if kind == "cylinder":
        around = np.maximum(np.hypot(points[:, 0], points[:, 1]), 1e-9)
        excess = np.column_stack((around - sizes[:, 0], np.abs(points[:, 2]) - sizes[:, 1]))
        height, parts = _beyond(excess)
        across = parts[:, :1] * points[:, :2] / around[:, None]
        return height, np.column_stack((across, parts[:, 1] * np.sign(points[:, 2])))
    height, parts = _beyond(np.abs(points) - sizes)
    return height, parts * np.sign(points)


def _beyond(excess: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the distance to a box from how far points are beyond each of its sides, and its slope in these."""
    outside = np.maximum(excess, 0)
    far = np.linalg.norm(outside, axis=1)
    nearest = (np.arange(excess.shape[1]) == excess.argmax(axis=1)[:, None]).astype(float)
    slope = np.where((far > 1e-9)[:, None], outside / np.maximum(far, 1e-9)[:, None], nearest)
    return far + np.minimum(excess.max(axis=1), 0), slope


def _blended(far: FloatArray, away: FloatArray, blend_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the smooth minimum of heights, shape (n, k), and its slope."""
    least = far.min(axis=1)
    known = np.isfinite(least)
    least = np.where(known, least, 0)
    shares = np.exp(-(far - least[:, None]) / blend_m[:, None])
    total = np.where(known, shares.sum(axis=1), 1)
    slope = np.einsum("nk,nki->ni", shares / total[:, None], away)
    return least - blend_m * np.log(total), np.where(known[:, None], slope, 0)

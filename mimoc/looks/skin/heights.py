"""Heights of points above solids, and the directions away from them."""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from mimoc.body.kinematics import Posed
from mimoc.body.tree import Geom
from mimoc.geometry.rotations import FloatArray

IntArray = npt.NDArray[np.intp]
LEAST_SLOPE = 0.3
"""Smallest square of a blended slope that is divided by: between two fingers, the slopes cancel."""


def heights(
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
    """
    number = {geom.name: index for index, geom in enumerate(posed.geoms)}
    far = np.full(near.shape, np.inf)
    away = np.zeros((*near.shape, 3))
    flat = near.ravel()
    order = np.argsort(flat, kind="stable")
    bounds = np.searchsorted(flat[order], np.arange(len(solids) + 1))
    for index, name in enumerate(solids):
        here = order[bounds[index] : bounds[index + 1]]
        if name in number and len(here):
            rows, columns = np.divmod(here, near.shape[1])
            geom, turn = posed.geoms[number[name]], posed.rotations[number[name]]
            local = (points[rows] - posed.centres[number[name]]) @ turn
            height, slope = height_above(geom, local)
            far[rows, columns] = height
            away[rows, columns] = slope @ turn.T
    return _blended(far, away, blend_m)


def height_above(geom: Geom, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the heights of points above a solid and the directions away from it, shapes (n,) and (n, 3).

    Args:
        geom: The solid.
        points: Shape (n, 3), in its frame.
    """
    size = geom.size_m
    if geom.type in ("sphere", "capsule"):
        end = size[1] if geom.type == "capsule" else 0.0
        axis = points.copy()
        axis[:, 2] -= np.clip(points[:, 2], -end, end)
        return _from(axis, size[0])
    if geom.type == "ellipsoid":
        half_axes = np.array(size)
        inner = np.linalg.norm(points / half_axes, axis=1)
        slope = points / half_axes**2
        steep = np.maximum(np.linalg.norm(slope, axis=1), 1e-9)
        return inner * (inner - 1) / steep, slope / steep[:, None]
    if geom.type == "cylinder":
        around = np.maximum(np.hypot(points[:, 0], points[:, 1]), 1e-9)
        excess = np.column_stack((around - size[0], np.abs(points[:, 2]) - size[1]))
        height, parts = _beyond(excess)
        across = parts[:, :1] * points[:, :2] / around[:, None]
        return height, np.column_stack((across, parts[:, 1] * np.sign(points[:, 2])))
    height, parts = _beyond(np.abs(points) - size)
    return height, parts * np.sign(points)


def _from(vectors: FloatArray, radius_m: float) -> tuple[FloatArray, FloatArray]:
    far = np.linalg.norm(vectors, axis=1)
    return far - radius_m, vectors / np.maximum(far, 1e-9)[:, None]


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

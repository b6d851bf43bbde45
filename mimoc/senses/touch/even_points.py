"""Points distributed evenly over the surface of a geom."""

import math

import numpy as np

from mimoc.body import Geom
from mimoc.geometry.ellipsoids import ellipse_perimeter
from mimoc.senses.touch.surface import FloatArray

ARC_STEPS = 720
"""Chords that an ellipse's outline is measured with; they are shorter than it by less than one part in 10,000."""


def even_points(geom: Geom, spacing_m: float) -> FloatArray:
    """Return about one point for each square of a spacing, as the multiples that `place` takes, shape (n, 4).

    Those of a box are in the middle of equal cells, all others on rings.
    """
    if geom.type == "box":
        return _on_box(geom.size_m, spacing_m)
    if geom.type == "ellipsoid":
        return _on_ellipsoid(geom.size_m, spacing_m)
    radius_m, half_m = (*geom.size_m, 0.0)[:2]
    return (_on_cylinder if geom.type == "cylinder" else _on_capsule)(radius_m, half_m, spacing_m)


def _on_box(half_edges_m: tuple[float, ...], spacing_m: float) -> FloatArray:
    cells = [_cells(_count(2 * half_m, spacing_m)) for half_m in half_edges_m]
    ends = np.array((-1.0, 1.0))
    faces = [np.meshgrid(*cells[:axis], ends, *cells[axis + 1 :]) for axis in range(3)]
    points = np.concatenate([np.stack([column.ravel() for column in face], axis=1) for face in faces])
    return np.column_stack((points, np.zeros(len(points))))


def _on_cylinder(radius_m: float, half_m: float, spacing_m: float) -> FloatArray:
    count = _count(2 * half_m, spacing_m)
    side = _rings(np.ones(count), _cells(count), radius_m * 2 * half_m / count / spacing_m**2)
    count = _count(radius_m, spacing_m)
    per_radian = radius_m**2 / count / spacing_m**2
    radii = (np.arange(count) + 0.5) / count
    radii[2 * math.pi * radii * per_radian < 1.5] = 0.0  # A single point is in the middle.
    return np.concatenate((side, *(_rings(radii, np.full(count, end), per_radian) for end in (-1.0, 1.0))))


def _on_capsule(radius_m: float, half_m: float, spacing_m: float) -> FloatArray:
    """Return points on rings that are equally far apart along the outline, from pole to pole."""
    cap_m, tube_m = math.pi / 2 * radius_m, 2 * half_m
    outline_m = cap_m + tube_m + cap_m
    count = _count(outline_m, spacing_m)
    from_pole_m = (_cells(count) + 1) / 2 * outline_m
    on_tube_m = np.clip(from_pole_m - cap_m, 0, tube_m)
    angles_rad = (from_pole_m - on_tube_m) / radius_m
    along = 2 * on_tube_m / tube_m - 1 if tube_m else np.zeros(count)
    per_radian = radius_m * outline_m / count / spacing_m**2
    return _rings(np.sin(angles_rad), -np.cos(angles_rad), per_radian, along)


def _on_ellipsoid(half_axes_m: tuple[float, ...], spacing_m: float) -> FloatArray:
    """Return points on level rings, equally far apart along the outline of a mean breadth and on each ring."""
    a, b, c = half_axes_m
    angles_rad, from_pole_m = _arcs(math.sqrt(a * b), c, math.pi)
    count = _count(from_pole_m[-1], spacing_m)
    polar_rad = np.interp((_cells(count) + 1) / 2 * from_pole_m[-1], from_pole_m, angles_rad)
    per_radian = ellipse_perimeter(a, b) / (2 * math.pi) * from_pole_m[-1] / count / spacing_m**2
    rings = _rings(np.sin(polar_rad), -np.cos(polar_rad), per_radian)
    angles_rad, around_m = _arcs(b, a, 2 * math.pi)
    evenly_m = np.arctan2(rings[:, 1], rings[:, 0]) % (2 * math.pi) / (2 * math.pi) * around_m[-1]
    turns_rad, radii = np.interp(evenly_m, around_m, angles_rad), np.hypot(rings[:, 0], rings[:, 1])
    return np.column_stack((radii * np.cos(turns_rad), radii * np.sin(turns_rad), rings[:, 2:]))


def _arcs(along: float, across: float, end_rad: float) -> tuple[FloatArray, FloatArray]:
    """Return angles from zero to an end, and how far an ellipse's outline is there from where it began.

    It begins at the end of the half axis `across`, and goes towards that of `along`.
    """
    angles_rad = np.linspace(0, end_rad, ARC_STEPS + 1)
    steps = np.hypot(np.diff(along * np.sin(angles_rad)), np.diff(across * np.cos(angles_rad)))
    return angles_rad, np.concatenate(([0.0], np.cumsum(steps)))


def _rings(radii: FloatArray, heights: FloatArray, per_radian: float, along: FloatArray | None = None) -> FloatArray:
    """Return points on rings about z; every other ring is turned by half a step, counted from the nearer end.

    Args:
        radii: Of the k rings, shape (k,).
        heights: Likewise.
        per_radian: Points on one radian of a ring of radius one.
        along: Last multiple of the points of each ring; else 0.
    """
    counts = np.maximum(np.rint(2 * math.pi * radii * per_radian), 1).astype(int)
    ring = np.repeat(np.arange(len(radii)), counts)
    number = np.arange(len(ring)) - np.repeat(np.cumsum(counts) - counts, counts)
    turn = np.minimum(ring, len(radii) - 1 - ring) % 2 / 2
    angles_rad = 2 * math.pi * (number + turn) / counts[ring]
    last = np.zeros(len(ring)) if along is None else along[ring]
    return np.column_stack((radii[ring] * np.cos(angles_rad), radii[ring] * np.sin(angles_rad), heights[ring], last))


def _cells(count: int) -> FloatArray:
    """Return the middles of equal cells from -1 to 1."""
    return (2 * np.arange(count) + 1) / count - 1


def _count(length_m: float, spacing_m: float) -> int:
    return max(1, round(length_m / spacing_m))

"""Implicit shapes: functions of points that are negative inside and about the distance to the surface near it.

Points have shape (n, 3), values shape (n,), both in mm.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import PchipInterpolator

Array = npt.NDArray[np.float64]
Field = Callable[[Array], Array]
Vector = Sequence[float] | Array


@dataclass(frozen=True)
class Solid:
    """A shape that belongs to a part of the body."""

    part: str  # Name of the body, with `{side}` for a limb.
    field: Field
    group: str  # What it is blended with: shapes of one group, then groups in the order of the figure.


def smooth_min(a: Array, b: Array, k: float) -> Array:
    """Return the smaller of two values, rounded where they differ by less than *k* (quadratic)."""
    h = np.clip(1 - np.abs(a - b) / k, 0, None)
    return np.minimum(a, b) - h * h * k / 4


def smooth_max(a: Array, b: Array, k: float) -> Array:
    """Return the larger of two values, rounded."""
    return -smooth_min(-a, -b, k)


def ball(centre: Vector, radius: float) -> Field:
    """Return a ball."""
    middle = np.asarray(centre, float)
    return lambda p: np.linalg.norm(p - middle, axis=1) - radius


def tube(start: Vector, end: Vector, radii: Sequence[float], at: Sequence[float] = ()) -> Field:
    """Return a tube with round ends, whose radius changes smoothly along it.

    Args:
        start: Middle of one end.
        end: Middle of the other.
        radii: Along it.
        at: Where it has these, from 0 to 1; evenly spaced by default.
    """
    a, along = np.asarray(start, float), np.subtract(end, start)
    places = np.linspace(0, 1, len(radii)) if len(at) == 0 else np.asarray(at, float)
    table = PchipInterpolator(places, radii)(np.linspace(0, 1, 101)) if len(radii) > 1 else np.full(101, radii[0])

    def field(p: Array) -> Array:
        t = np.clip((p - a) @ along / (along @ along), 0, 1)
        return np.linalg.norm(p - a - t[:, None] * along, axis=1) - np.interp(t, np.linspace(0, 1, 101), table)

    return field


def ellipsoid(centre: Vector, half_axes: Vector, turn: Array | None = None) -> Field:
    """Return an ellipsoid, whose axes are the columns of *turn*."""
    middle, axes = np.asarray(centre, float), np.asarray(half_axes, float)

    def field(p: Array) -> Array:
        q = (p - middle) if turn is None else (p - middle) @ turn
        inner = np.linalg.norm(q / axes, axis=1)
        slope = np.linalg.norm(q / axes**2, axis=1)
        return np.where(slope > 1e-9, inner * (inner - 1) / np.maximum(slope, 1e-9), -axes.min())

    return field


def rounded_box(centre: Vector, half_edges: Vector, rounding: float) -> Field:
    """Return a box with rounded edges; the half edges include the rounding."""
    middle, edges = np.asarray(centre, float), np.asarray(half_edges, float) - rounding

    def field(p: Array) -> Array:
        q = np.abs(p - middle) - edges
        outside = np.linalg.norm(np.maximum(q, 0), axis=1)
        return outside + np.minimum(q.max(axis=1), 0) - rounding

    return field


def column(sections: Sequence[tuple[float, float, float, float, float]], power: float = 2.4) -> Field:
    """Return an upright column of superelliptic sections, unbounded at both ends.

    Args:
        sections: Height, place of the back, place of the front, half width, and how far the widest place is from the
            back (0) to the front (1); from the lowest.
        power: 2 is an ellipse, more is more like a box.
    """
    heights, back, front, half, wide = np.array(sections, float).T
    middle = back + wide * (front - back)
    tables = [PchipInterpolator(heights, each) for each in (middle, front - middle, middle - back, half)]

    def field(p: Array) -> Array:
        z = np.clip(p[:, 2], heights[0], heights[-1])
        centre, ahead, behind, b = (table(z) for table in tables)
        x = p[:, 0] - centre
        a = np.where(x > 0, ahead, behind)
        u, v = np.abs(x) / a, np.abs(p[:, 1]) / b
        g = np.maximum((u**power + v**power) ** (1 / power), 1e-6)
        slope = g ** (1 - power) * np.hypot(u ** (power - 1) / a, v ** (power - 1) / b)
        return (g - 1) / np.maximum(slope, 1e-6)

    return field


def moved(field: Field, origin: Array, turn: Array) -> Field:
    """Return a shape given in a frame, in the frame in which the first one has this origin and rotation."""
    return lambda p: field((p - origin) @ turn)

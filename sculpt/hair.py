"""Where hair grows on the head's mesh, and which way it falls. Lengths are mm."""

from dataclasses import dataclass

import numpy as np
from fields import Array
from scipy.interpolate import PchipInterpolator

WHORL = np.array((-0.52, 0.0, 0.85))
"""Direction of the whorl, from the middle of the head."""
AROUND_DEG = (0, 25, 42, 56, 68, 76, 86, 100, 114, 128, 150, 180)
LINE_DEG = (44, 43, 39, 29, 11, -2, 3, 5, -3, -19, -35, -41)
"""Elevation of the hairline by how far to the side, from the front to the nape: above the ears and behind them (D)."""
FRINGE_DEG = (-14, -13, -7, -2, -1, -1, 0, 0, 0, 0, 0, 0)
"""How much lower it is where a fringe falls onto the forehead."""
WAVES = 0.016
"""How much hair turns aside here and there, as a share of half a turn."""
RIM_DEG = 9.0
"""How far beyond the lowest hairline the layer goes on."""
WORN = np.array((-0.98, 0.0, 0.05))
"""Direction of the middle of what rubs on the ground."""


@dataclass(frozen=True)
class Scalp:
    """The part of the head's mesh that has hair, of n vertices."""

    verts: np.ndarray
    """Of the head, shape (n,)."""
    faces: np.ndarray
    """Of these, shape (m, 3)."""
    inside: Array
    """How far within the hairline they are, and how much farther with a full fringe, [deg], shape (n, 2)."""
    around: Array
    """Which way from the whorl, 0 to 1, the same on both sides, shape (n,)."""
    worn: Array
    """How much of the hair rubs off on the ground, 0 to 1, shape (n,)."""


def scalp(half_axes: Array, verts: Array, faces: np.ndarray) -> Scalp:
    """Return where a head has hair.

    Args:
        half_axes: Of the head's solid, shape (3,).
        verts: Of the head, in the frame of its solid.
        faces: Of the head.
    """
    ways = verts / half_axes
    ways = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    inside = _inside(ways)
    is_ear = (np.abs(verts[:, 1]) > 1.045 * half_axes[1]) & (np.abs(ways[:, 2] + 0.1) < 0.32)
    near = (inside.sum(axis=1) > -RIM_DEG) & ~is_ear
    faces = _welded(verts, faces)
    kept = faces[near[faces].all(axis=1)]
    used = np.unique(kept)
    number = np.zeros(len(verts), np.intp)
    number[used] = np.arange(len(used))
    worn = np.exp(-((np.degrees(np.arccos(np.clip(ways @ (WORN / np.linalg.norm(WORN)), -1, 1))) / 27) ** 2))
    return Scalp(used, number[kept], inside[used], _around(ways)[used], worn[used])


def _welded(verts: Array, faces: np.ndarray) -> np.ndarray:
    """Return faces of a mesh in which vertices in one place are one."""
    _, first, same = np.unique(verts, axis=0, return_index=True, return_inverse=True)
    welded = first[same.reshape(-1)][faces]
    return welded[(welded != np.roll(welded, 1, axis=1)).all(axis=1)]


def _inside(ways: Array) -> Array:
    azimuth = np.degrees(np.abs(np.arctan2(ways[:, 1], ways[:, 0])))
    elevation = np.degrees(np.arcsin(np.clip(ways[:, 2], -1, 1)))
    line, fringe = (PchipInterpolator(AROUND_DEG, table)(azimuth) for table in (LINE_DEG, FRINGE_DEG))
    return np.column_stack((elevation - line, -fringe))


def _around(ways: Array) -> Array:
    whorl = WHORL / np.linalg.norm(WHORL)
    front = np.array((1.0, 0, 0)) - whorl[0] * whorl
    front /= np.linalg.norm(front)
    aside = np.cross(whorl, front)
    around = np.abs(np.arctan2(ways @ aside, ways @ front)) / np.pi
    far = np.arccos(np.clip(ways @ whorl, -1, 1))
    waves = np.sin(4.2 * far + 11 * around) + 0.6 * np.sin(7.5 * far - 17 * around + 1)
    return around + WAVES * np.sin(np.pi * around) * waves

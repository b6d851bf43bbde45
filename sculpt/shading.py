"""Where each vertex is in the texture of its layer: how rosy it is, how deep in a crease, in which stripe."""

import meshing
import numpy as np
from fields import Array
from figure import Figure
from weights import owners

STRIPE_MM = 26.0
"""Breadth of a light and a dark stripe of the shirt together."""
REACH_MM = (1.5, 3.0, 6.0, 11.0)
"""Distances from the surface at which it is asked how much of the space is filled."""


def texcoords(name: str, verts: Array, faces: np.ndarray, figure: Figure, hands: str) -> Array:
    """Return places in the texture of a layer, shape (n, 2): rosiness or stripe, and openness, 0 to 1."""
    open_space = openness(figure, verts)
    if name == "body":
        return np.column_stack((0.02 + 0.96 * rosiness(figure, verts), 0.02 + 0.96 * open_space))
    if name == "shirt":
        return np.column_stack((verts[:, 2] / STRIPE_MM, 0.02 + 0.96 * open_space))
    return np.column_stack((np.full(len(verts), 0.5), 0.02 + 0.96 * open_space))


def openness(figure: Figure, verts: Array) -> Array:
    """Return how much of the space above each vertex is free, 0 to 1."""
    field = figure.field()
    normal = meshing.gradient(field, verts)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-9)
    base = field(verts)
    free = [np.clip((field(verts + far * normal) - base) / far, 0, 1) for far in REACH_MM]
    return np.clip((np.mean(free, axis=0) - 0.35) / 0.65, 0, 1)


def rosiness(figure: Figure, verts: Array) -> Array:
    """Return how rosy the skin is, 0 to 1: knees, elbows, fingers, toes, palms and soles."""
    names = owners(verts, figure.solids)
    fingers = np.array([any(word in name for word in ("finger", "toe", "distal", "middle")) for name in names])
    found = 0.35 * fingers
    for side in ("left", "right"):
        for part, radius, most in (
            ("lower_leg", 24, 0.7),
            ("lower_arm", 22, 0.6),
            ("foot", 18, 0.7),
        ):
            joint = figure.joints[f"{side}_{part}"]
            found = np.maximum(found, most * np.exp(-(((np.linalg.norm(verts - joint, axis=1) - 14) / radius) ** 2)))
    return np.clip(found, 0, 1)

"""Where each vertex is in textures: how rosy it is, how deep in a crease, in which stripe, how near a hem."""

import meshing
import numpy as np
from embedding import Drawn
from fields import Array
from figure import Figure
from pictures.cloth import BANDS, PLACES, shade_of
from tailoring import GARMENTS, Cut
from weights import owners

STRIPE_MM = 26.0  # Breadth of a light and a dark stripe of the shirt together.
REACH_MM = (1.5, 3.0, 6.0, 11.0)  # Distances from the surface at which it is asked how much of the space is filled.


def texcoords(drawn: Drawn, figure: Figure, cut: Cut, hanging_mm: Array) -> dict[str, np.ndarray]:
    """Return places in the texture of skin, along the pattern of cloth, and in the shades of each garment."""
    free = openness(figure, drawn.verts)
    shades = [shade_of(PLACES[name], cut.hem_mm[name] / BANDS[name], free) for name in GARMENTS]
    return {
        "texcoords": np.column_stack((0.02 + 0.96 * rosiness(figure, drawn.verts), 0.02 + 0.96 * free)).astype(
            np.float32
        ),
        "pattern": (hanging_mm / STRIPE_MM).astype(np.float32),
        "shades": np.rint(255 * np.array(shades)).astype(np.uint8),
    }


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
    rosy = 0.35 * fingers
    for side in ("left", "right"):
        for part, radius, most in (
            ("lower_leg", 24, 0.7),
            ("lower_arm", 22, 0.6),
            ("foot", 18, 0.7),
        ):
            joint = figure.joints[f"{side}_{part}"]
            rosy = np.maximum(rosy, most * np.exp(-(((np.linalg.norm(verts - joint, axis=1) - 14) / radius) ** 2)))
    return np.clip(rosy, 0, 1)

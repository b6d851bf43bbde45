"""The surface of the whole body as one symmetric mesh, with the hems of all clothes drawn into it. Lengths are mm."""

from collections.abc import Mapping

import embedding
import features
import figure
import meshing
import numpy as np
import tailoring
import weights
from fields import Array

from mimoc.body.kinematics import Frame

LOW, HIGH = np.array((-80.0, -280.0, -300.0)), np.array((270.0, 280.0, 320.0))
TOP = 308.0  # Above this height the neck is in the head.
SIZES = {
    "hand": 4.9,
    "lfmetacarpal": 4.6,
    "thbase": 4.6,
    "foot": 6.4,
    "toes": 3.9,
    "big_toe": 4.2,
    "fingers": 3.6,
    "upper_arm": 9.5,
    "lower_arm": 9.0,
    "upper_leg": 10.0,
    "lower_leg": 10.0,
    **dict.fromkeys(("hip", "lower_body", "upper_body", "chest", "head"), 12.5),
}
FINGER_SIZE = 3.3  # Lengths of edges, by body.
SEPARATE = {"hand": 5.3, "lfmetacarpal": 4.9, "thbase": 4.8, "toes": 4.3, "big_toe": 4.5, "foot": 6.8}
SEPARATE_FINGER_SIZE = 3.7  # The same of hands with five fingers, which have more bodies for a file to name.


def mesh(
    sculpted: figure.Figure, frames: Mapping[str, Frame], cell_mm: float, rng: np.random.Generator
) -> tuple[embedding.Drawn, Mapping[str, embedding.Curve]]:
    """Return the mesh and the hems."""
    field, curves = sculpted.field(), tailoring.hems(frames)
    fined = features.finer(frames)

    def size(points: Array) -> Array:
        return fined(points, sizes(sculpted, points))

    dense = meshing.largest(*meshing.surface(field, LOW, HIGH, cell_mm))
    dense = meshing.only(*dense, dense[0][:, 2] < TOP)
    verts, faces = meshing.remesh(*dense, size, rng)
    verts = meshing.relax(field, meshing.onto(field, verts), faces, rounds=3)
    half = embedding.right_half(field, verts, meshing.without_fins(faces))
    drawn = embedding.embedded(field, half, tuple(curves.values()), size)
    whole = embedding.mirrored(drawn)
    print("body", len(dense[0]), "->", len(whole.verts), "defects", meshing.defects(whole.faces))
    return whole, curves


def sizes(sculpted: figure.Figure, points: Array) -> Array:
    """Return the length of edges that is wanted at some points."""
    owners = weights.owners(points, sculpted.solids)
    is_separate = any("thbase" in solid.part for solid in sculpted.solids)
    table, finger = (SIZES | SEPARATE, SEPARATE_FINGER_SIZE) if is_separate else (SIZES, FINGER_SIZE)
    parts = {name: table.get(name.removeprefix("left_").removeprefix("right_"), finger) for name in set(owners)}
    return np.array([parts[name] for name in owners])

"""Which bodies move each vertex, and how much."""

from collections.abc import Mapping, Sequence

import numpy as np
from cutting import Drawn
from fields import Array, Solid
from figure import Figure, folded
from meshing import edges_of
from scipy.sparse import coo_matrix, diags, eye
from scipy.sparse.linalg import splu

from mimoc.base.geometry.solvers import smoothstep
from mimoc.body.kinematics import Frame

BONES = 4  # Bodies that move a vertex, at most.
MIN_WEIGHT = 0.022  # Smaller weights are left out.
SPREAD = {
    "upper_arm": 26.0,
    "lower_arm": 13.0,
    "upper_leg": 16.0,
    "lower_leg": 21.0,
    "foot": 12.0,
    "toes": 6.0,
    "big_toe": 6.0,
    "hand": 8.0,
    "fingers": 5.0,
    "lfmetacarpal": 5.0,
    "thbase": 7.0,
}
"""How far the hold of a body fades out along the skin, [mm]; of fingers and of the trunk below."""
TRUNK, FINGER = 30.0, 2.9
WIDER = (
    ("hip", (0.0, 0.0, -55.0), 52.0, 20.0),
    ("right_upper_leg", (0.0, 0.0, 0.0), 60.0, 16.0),
    ("right_upper_leg", (30.0, 20.0, -30.0), 36.0, 12.0),
    ("right_upper_arm", (0.0, 0.0, 0.0), 45.0, 10.0),
    ("head", (0.0, 0.0, -12.0), 50.0, 10.0),
    ("right_thbase", (0.0, 0.0, 8.0), 15.0, 5.0),
)
"""Around crotch, groin, shoulders, neck and thumb it fades out farther: body, place in it, over what, by what."""
REACHES = {"hand": (18.0, 32.0), "lower_arm": (34.0, 80.0), "lower_leg": (44.0, 86.0)}
"""Distances from an elbow, a wrist or a knee at which a body's hold on the skin beyond it begins to end, and ends."""
LUMBAR = (("hip", -99.0, 23.0), ("lower_body", 23.0, 104.0), ("upper_body", 104.0, 226.0), ("chest", 226.0, 999.0))
"""Bodies of the trunk, from height to height, [mm]."""


def weights(drawn: Drawn, figure: Figure, frames: Mapping[str, Frame], parents: Mapping[str, str]) -> Array:
    """Return the weight of each body for each vertex, shape (vertices, bodies).

    At most four are above 0; they sum to 1.

    Args:
        drawn: The mesh.
        figure: Its shapes.
        frames: Those of the bodies.
        parents: The parent of each body; "" for the first.
    """
    names = [*parents]
    verts, owner = drawn.verts, owners(drawn.verts, figure.solids)
    index = {name: number for number, name in enumerate(names)}
    start = np.zeros((len(verts), len(names)))
    start[np.arange(len(verts)), [index[name] for name in owner]] = 1
    spread = np.array([_spread(name) for name in owner])
    for body, place, radius, most in WIDER:
        if body not in frames:
            continue
        origin, turn = frames[body]
        far = np.linalg.norm(folded(verts) - origin * 1000 - turn @ np.array(place), axis=1)
        spread += most * np.exp(-((far / radius) ** 2))
    held = _most(verts, owner, frames, parents) * _diffused(verts, drawn.faces, start, spread)
    return symmetric(held, drawn.twins, names)


def _most(verts: Array, owner: np.ndarray, frames: Mapping[str, Frame], parents: Mapping[str, str]) -> Array:
    """Return how much of its weight each body may have at each vertex: less, the farther the joint is."""
    most = np.ones((len(verts), len(parents)))
    for name in np.unique(owner):
        (rows,) = np.nonzero(owner == name)
        above = _line(name, parents)
        for column, other in enumerate(parents):
            joint = above[above.index(other) - 1] if other in above[1:] else other
            low, high = REACHES.get(joint.removeprefix("left_").removeprefix("right_"), (np.inf, np.inf))
            if other == name or np.isinf(low):
                continue
            far = np.linalg.norm(verts[rows] - frames[joint][0] * 1000, axis=1)
            most[rows, column] = 1 - smoothstep((far - low) / (high - low))
    return most


def _line(name: str, parents: Mapping[str, str]) -> list[str]:
    """Return a body, its parent, the parent of that, and so on."""
    return [name, *_line(parents[name], parents)] if name else []


def owners(verts: Array, solids: Sequence[Solid]) -> np.ndarray:
    """Return the body whose shape is nearest to each vertex; of the trunk, the one at its height."""
    shapes = [solid for solid in solids if solid.group != "sole"]
    distances = np.column_stack([solid.field(folded(verts)) + _late(solid) for solid in shapes])
    nearest = distances.argmin(axis=1)
    sides = np.where(verts[:, 1] > 0, "left", "right")
    names = [shapes[index].part.format(side=side) for index, side in zip(nearest, sides, strict=True)]
    levels = np.searchsorted([high for _, _, high in LUMBAR], verts[:, 2])
    trunk = {"hip", "chest"}
    return np.array([LUMBAR[level][0] if name in trunk else name for name, level in zip(names, levels, strict=True)])


def _late(solid: Solid) -> float:
    """Return how much farther a shape counts as, so that webs between fingers belong to the palm."""
    return {"finger": 1.3, "toe": 1.2, "neck": 2.0}.get(solid.group, 0.0)


def _spread(name: str) -> float:
    part = name.removeprefix("left_").removeprefix("right_")
    if part in ("hip", "lower_body", "upper_body", "chest", "head"):
        return TRUNK
    return SPREAD.get(part, FINGER)


def _diffused(verts: Array, faces: np.ndarray, start: Array, spread: Array) -> Array:
    """Return weights that fade out along the skin over a distance: the solution of (1 - spread² Laplace) w = start."""
    edges = edges_of(faces)
    count = len(verts)
    lengths = np.linalg.norm(verts[edges[:, 0]] - verts[edges[:, 1]], axis=1)
    ones = coo_matrix((np.ones(len(edges)), edges.T), shape=(count,) * 2)
    ones = (ones + ones.T).tocsr()
    degree = np.maximum(np.asarray(ones.sum(axis=1)).ravel(), 1)
    size = np.bincount(edges.ravel(), np.repeat(lengths, 2), minlength=count) / degree
    average = diags(1 / degree) @ ones
    for _ in range(6):
        spread = 0.5 * spread + 0.5 * (average @ spread)
    share = 4 * (spread / size) ** 2
    half = splu((eye(count) + diags(share / 2) @ (eye(count) - average)).tocsc())
    return half.solve(half.solve(start))


def quantized(values: Array) -> Array:
    """Return weights of at most four bodies for each vertex, as 255ths that sum to 1."""
    order = np.argsort(-values, axis=1)[:, :BONES]
    top = np.take_along_axis(values, order, axis=1)
    top = np.where(top < MIN_WEIGHT, 0, top)
    top /= top.sum(axis=1, keepdims=True)
    parts = np.floor(top * 255)
    parts[:, 0] += 255 - parts.sum(axis=1)
    rounded = np.zeros_like(values)
    np.put_along_axis(rounded, order, parts / 255, axis=1)
    return rounded


def symmetric(held: Array, twins: np.ndarray, names: Sequence[str]) -> Array:
    """Return weights of which those of mirrored vertices are of mirrored bodies."""
    sides = {"left": "right", "right": "left"}
    other = [
        list(names).index(f"{sides[side]}_{rest}" if (side := name.partition("_")[0]) in sides else name)
        for name in names
        for rest in [name.partition("_")[2]]
    ]
    return quantized((held + held[twins][:, other]) / 2)

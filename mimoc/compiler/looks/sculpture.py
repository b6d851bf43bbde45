"""The sculpted skin of a child, as it ships with mimoc, and the clothes that are parts of it.

`.ci/task skin` makes the sculpture (see `sculpt/`). Clothes are regions of the body's mesh that are raised above the
skin, so that they move as it does. A hem is an edge of such a region. There, a strip of cloth leads down to what is
below: skin, or another garment.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache, lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.arrays import Arrays, read_arrays
from mimoc.base.errors import DataError
from mimoc.base.geometry.rotations import FloatArray

IntArray = npt.NDArray[np.intp]
FOLDER = Path(__file__).parent / "sculpted"
BODY = "body"
"""What several bodies move: the name of the layer of bare skin, and of the mesh that clothes are parts of."""
HEAD = "head"  # What one body moves: the name of the layer, the body and the solid.
HAIR = "hair"  # The layer over it, which the same body moves.
MOVE_M = 1e-5  # Unit of the moves of an expression in the file.


@dataclass(frozen=True, slots=True, eq=False)
class SculptedMesh:
    """The whole surface of the reference child but its head, n vertices, in the pose that it is bound in."""

    verts_m: FloatArray  # Vertices in the frame of the hip, shape (n, 3).
    faces: IntArray  # Vertices of each triangle, seen from outside counterclockwise, shape (m, 3).
    texcoords: FloatArray  # Place in the texture, shape (n, 2).
    bones: IntArray  # Bodies that move each vertex, as indices of `Sculpture.parts`, shape (n, 4).
    weights: FloatArray  # How much each of them does, shape (n, 4); each row sums to 1.
    near: IntArray  # The solids near each vertex, as indices of `Sculpture.solids`, shape (n, 4).
    offsets_m: FloatArray  # Height of each vertex above these, blended, shape (n,).
    blend_m: FloatArray  # Width of that blend, shape (n,).


@dataclass(frozen=True, slots=True, eq=False)
class Garment:
    """A part of the body's mesh, of n vertices and m faces, that is raised as cloth."""

    is_covered: npt.NDArray[np.bool_]  # Whether each face is of it, shape (m,).
    lifts_m: FloatArray  # How high its cloth is above each vertex, shape (n,).
    texcoords: FloatArray
    """Place in the texture of its layer: along the pattern, and how near a hem or how deep in a fold, shape (n, 2)."""


@dataclass(frozen=True, slots=True, eq=False)
class SculptedHair:
    """The part of the head's mesh that has hair, of n vertices."""

    verts: IntArray  # Indices of these vertices among those of the head, shape (n,).
    faces: IntArray  # Vertices of each triangle, as indices of `verts`, shape (m, 3).
    inside_deg: FloatArray
    """How far within the hairline each is, and how much farther if there is a full fringe, shape (n, 2)."""
    around: FloatArray  # Which way from the whorl, 0 to 1, the same on both sides, shape (n,).
    worn: FloatArray  # How much of the hair rubs off on the ground, 0 to 1, shape (n,).


@dataclass(frozen=True, slots=True, eq=False)
class SculptedHead:
    """The mesh of the head on the reference child, in the frame of the head's solid."""

    ages_months: FloatArray  # Ages that it was sculpted at, rising, shape (ages,).
    at_ages_m: FloatArray
    """The vertices at these ages, as if the head's solid were always the same, shape (ages, n, 3)."""
    lids: FloatArray
    """How far the lids are open at these ages, upper and lower, by how far they are in the mesh, shape (ages, 2)."""
    moves_m: Mapping[str, FloatArray]
    """How each vertex moves from the neutral to another expression, lids aside, by expression, shape (n, 3)."""
    lids_by_expression: Mapping[str, FloatArray]  # How far the lids are open then, by how far they are, shape (2,).
    faces: IntArray
    texcoords: FloatArray
    half_axes_m: FloatArray  # Half axes of the head's solid, shape (3,).
    eye_m: FloatArray  # Middle of the right eye, shape (3,).
    eye_radius_m: float
    hair: SculptedHair


@dataclass(frozen=True, slots=True, eq=False)
class Sculpture:
    """The skin of a reference child with one kind of hands."""

    parts: tuple[str, ...]  # Names of its bodies.
    parents: Mapping[str, str]  # Parent of each body but the hip.
    origins_m: FloatArray  # Origins of the bodies in the frame of the hip, shape (bodies, 3).
    turns: FloatArray  # Hip from body, shape (bodies, 3, 3).
    low_m: FloatArray  # Least corner of the box around a body's solids, in the frame of the body, shape (bodies, 3).
    high_m: FloatArray  # The opposite corner.
    solids: tuple[str, ...]  # Names of its geoms.
    angles_rad: Mapping[str, float]  # The pose that the skin is bound in, by joint; others are at zero.
    head_radius_m: float  # Radius of a circle with the head's circumference.
    mesh: SculptedMesh
    garments: Mapping[str, Garment]
    ages_months: FloatArray  # Ages that the body is sculpted at.
    fullness_m: FloatArray  # How much fuller than its solids the body is at each of these ages, shape (ages, n).
    head: SculptedHead


@cache
def template_mesh(hands: str) -> Sculpture:
    """Return the skin for a kind of hands: `mitten` or `five_finger`."""
    return assembled(read_arrays(FOLDER / f"{hands}.npz"), read_arrays(FOLDER / "head.npz"))


def assembled(arrays: Arrays, head: Arrays) -> Sculpture:
    """Return a sculpture from its arrays, by their names in the files; a DataError says which are not of one."""
    parts, solids = _names(arrays, "parts", "bones"), _names(arrays, "solids", "near")
    mesh = {field.name: _fixed(arrays[field.name]) for field in fields(SculptedMesh) if field.name != "offsets_m"}
    names = ("ages_months", "at_ages_m", "lids", "faces", "texcoords", "half_axes_m", "eye_m")
    expressions = [name.removeprefix("moves/") for name in head if name.startswith("moves/")]
    return Sculpture(
        parts=parts,
        parents=MappingProxyType(
            {part: str(name) for part, name in zip(parts, arrays["parents"], strict=True) if name}
        ),
        **{name: _fixed(arrays[name]) for name in ("origins_m", "turns", "low_m", "high_m")},
        solids=solids,
        angles_rad=MappingProxyType(dict(zip(map(str, arrays["joints"]), arrays["angles_rad"].tolist(), strict=True))),
        head_radius_m=float(arrays["head_radius_m"]),
        mesh=SculptedMesh(
            **{**mesh, "weights": mesh["weights"] / 255, "offsets_m": arrays["offsets_um"] * 1e-6},
        ),
        garments=MappingProxyType(
            {str(name): _garment(arrays, index) for index, name in enumerate(arrays["garments"])}
        ),
        ages_months=_fixed(arrays["ages_months"]),
        fullness_m=arrays["fullness_100um"] * 1e-4,
        head=SculptedHead(
            **{name: _fixed(head[name]) for name in names},
            moves_m=MappingProxyType({name: _fixed(head[f"moves/{name}"] * MOVE_M) for name in expressions}),
            lids_by_expression=MappingProxyType({name: _fixed(head[f"lids/{name}"]) for name in expressions}),
            eye_radius_m=float(head["eye_radius_m"]),
            hair=SculptedHair(**{field.name: _fixed(head[f"hair/{field.name}"]) for field in fields(SculptedHair)}),
        ),
    )


def _names(arrays: Arrays, names: str, indices: str) -> tuple[str, ...]:
    found, highest = arrays[names], int(arrays[indices].max())
    if found.dtype.kind != "U" or found.ndim != 1 or len(set(found.tolist())) < len(found):
        raise DataError(f"skin: '{names}' is no list of different names; run `.ci/task skin`")
    if highest >= len(found):
        raise DataError(f"skin: '{indices}' refers to number {highest} of {len(found)} '{names}'; run `.ci/task skin`")
    return tuple(found.tolist())


def _garment(arrays: Arrays, index: int) -> Garment:
    across = np.column_stack((arrays["pattern"], arrays["shades"][index] / 255))
    return Garment(
        is_covered=(arrays["covers"] >> index & 1).astype(bool),
        lifts_m=arrays["lifts_50um"][index] * 5e-5,
        texcoords=_fixed(across),
    )


def _fixed(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    fixed = array.astype(np.float64 if array.dtype.kind == "f" else np.intp)
    fixed.flags.writeable = False
    return fixed


BARE = "bare"  # The outfit of a body that is only measured.
OUTFITS: Mapping[str, Mapping[str, str]] = {
    "bodysuit": {"shirt": "bodysuit"},
    "shirt_and_trousers": {"shirt": "shirt", "trousers": "trousers"},
    "trousers": {"trousers": "trousers"},
    "nappy": {"trousers": "nappy"},
    BARE: {},
}
"""The garments of each outfit, by the layer of skin that they are, from the outermost."""
SUNK_M = 0.0007  # How deep in what is below it a hem ends (D).


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """One layer of a dressed body: its n vertices are vertices of the body, raised along its normals."""

    name: str
    sources: IntArray  # The vertex of the body that each is, shape (n,).
    lifts_m: FloatArray  # How high it is above that, on the reference child, shape (n,).
    faces: IntArray
    texcoords: FloatArray


@lru_cache(maxsize=16)
def dressed(sculpted: Sculpture, outfit: str) -> tuple[Piece, ...]:
    """Return the layers of a body in an outfit, a key of `OUTFITS`: what is bare, then its clothes."""
    worn = [(layer, sculpted.garments[name]) for layer, name in OUTFITS[outfit].items()]
    rank = np.full(len(sculpted.mesh.faces), len(worn))
    for number, (_, garment) in reversed([*enumerate(worn)]):
        rank[garment.is_covered] = number
    levels_m = [*(garment.lifts_m for _, garment in worn), np.zeros(len(sculpted.mesh.verts_m))]
    return (
        _piece(BODY, sculpted.mesh.faces[rank == len(worn)], levels_m[-1], sculpted.mesh.texcoords),
        *(_sewn(sculpted, layer, garment, rank, number, levels_m) for number, (layer, garment) in enumerate(worn)),
    )


def _piece(name: str, faces: IntArray, lifts_m: FloatArray, texcoords: FloatArray) -> Piece:
    used, numbered = np.unique(faces, return_inverse=True)
    return Piece(name, used, lifts_m[used], numbered.reshape(-1, 3), texcoords[used])


def _sewn(
    sculpted: Sculpture, layer: str, garment: Garment, rank: IntArray, number: int, levels_m: list[FloatArray]
) -> Piece:
    """Return a garment with strips at those hems beside which there is what is below it."""
    faces = sculpted.mesh.faces
    cloth = _piece(layer, faces[rank == number], levels_m[number], garment.texcoords)
    rim, beside = _rim(faces, rank, number)
    ends, first = np.unique(rim[:, 0], return_index=True)
    below_m = np.array(levels_m)[beside[first], ends] - SUNK_M
    upper = np.searchsorted(cloth.sources, rim)
    lower = len(cloth.sources) + np.searchsorted(ends, rim)
    strip = np.stack((upper[:, 1], upper[:, 0], lower[:, 0], upper[:, 1], lower[:, 0], lower[:, 1]), axis=1)
    return Piece(
        layer,
        np.concatenate((cloth.sources, ends)),
        np.concatenate((cloth.lifts_m, below_m)),
        np.vstack((cloth.faces, strip.reshape(-1, 3))),
        np.vstack((cloth.texcoords, garment.texcoords[ends])),
    )


def _rim(faces: IntArray, rank: IntArray, number: int) -> tuple[IntArray, IntArray]:
    """Return the edges of the faces of a rank beside which there are faces of a higher rank, and the ranks of these.

    An edge goes from one vertex to another, shape (n, 2), as its face is seen counterclockwise.
    """
    edges = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    ranks = np.repeat(rank, 3)
    count = faces.max() + 1
    forth, back = edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0]
    order = np.argsort(forth, kind="stable")
    place = order[np.minimum(np.searchsorted(forth[order], back), len(order) - 1)]
    beside = np.where(forth[place] == back, ranks[place], -1)
    chosen = (ranks == number) & (beside > number)
    return edges[chosen], beside[chosen]

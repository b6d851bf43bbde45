"""Clothes: regions of the body's mesh that are raised above the skin, so that they move as it does.

A hem is an edge of such a region. There, a strip of cloth leads down to what is below: skin, or another garment.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from mimoc.base.geometry.rotations import FloatArray
from mimoc.compiler.looks.skin.template_mesh import BODY, Garment, IntArray, Sculpture

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
    edges, ranks = faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), np.repeat(rank, 3)
    count = faces.max() + 1
    forth, back = edges[:, 0] * count + edges[:, 1], edges[:, 1] * count + edges[:, 0]
    order = np.argsort(forth, kind="stable")
    place = order[np.minimum(np.searchsorted(forth[order], back), len(order) - 1)]
    beside = np.where(forth[place] == back, ranks[place], -1)
    chosen = (ranks == number) & (beside > number)
    return edges[chosen], beside[chosen]

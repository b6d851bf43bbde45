"""The sculpted skin of a child, as it ships with mimoc; `make skin` makes it (see `sculpt/`)."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.geometry.rotations import FloatArray

IntArray = npt.NDArray[np.intp]
FOLDER = Path(__file__).parent / "sculpted"
BODY = "body"
"""What several bodies move: the name of the layer of bare skin, and of the mesh that clothes are parts of."""
HEAD = "head"
"""What one body moves: the name of the layer, the body and the solid."""


@dataclass(frozen=True, slots=True, eq=False)
class SculptedMesh:
    """The whole surface of the reference child but its head, n vertices, in the pose that it is bound in."""

    verts_m: FloatArray
    """In the frame of the hip, shape (n, 3)."""
    faces: IntArray
    """Vertices of each triangle, seen from outside counterclockwise, shape (m, 3)."""
    texcoords: FloatArray
    """Place in the texture, shape (n, 2)."""
    bones: IntArray
    """Bodies that move each vertex, as indices of `Sculpture.parts`, shape (n, 4)."""
    weights: FloatArray
    """How much each of them does, shape (n, 4); each row sums to 1."""
    solids: IntArray
    """The solids near each vertex, as indices of `Sculpture.solids`, shape (n, 4)."""
    offsets_m: FloatArray
    """Height of each vertex above these, blended, shape (n,)."""
    blend_m: FloatArray
    """Width of that blend, shape (n,)."""


@dataclass(frozen=True, slots=True, eq=False)
class Garment:
    """A part of the body's mesh, of n vertices and m faces, that is raised as cloth."""

    is_covered: npt.NDArray[np.bool_]
    """Whether each face is of it, shape (m,)."""
    lifts_m: FloatArray
    """How high its cloth is above each vertex, shape (n,)."""
    texcoords: FloatArray
    """Place in the texture of its layer: along the pattern, and how near a hem or how deep in a fold, shape (n, 2)."""


@dataclass(frozen=True, slots=True, eq=False)
class SculptedHead:
    """The mesh of the head on the reference child, in the frame of the head's solid."""

    verts_m: FloatArray
    """At nine months and more, shape (n, 3)."""
    newborn_m: FloatArray
    """At birth."""
    closing_m: Mapping[str, FloatArray]
    """How each vertex moves where an eye is missing, so that the lids close, by side; shape (n, 3)."""
    faces: IntArray
    texcoords: FloatArray
    half_axes_m: FloatArray
    """Of the head's solid, shape (3,)."""
    eye_m: FloatArray
    """Middle of the right eye, shape (3,)."""
    eye_radius_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Sculpture:
    """The skin of a reference child with one kind of hands."""

    parts: tuple[str, ...]
    """Names of its bodies."""
    parents: Mapping[str, str]
    """Parent of each body but the hip."""
    origins_m: FloatArray
    """Of the bodies in the frame of the hip, shape (bodies, 3)."""
    turns: FloatArray
    """Hip from body, shape (bodies, 3, 3)."""
    low_m: FloatArray
    """Least corner of the box around a body's solids, in the frame of the body, shape (bodies, 3)."""
    high_m: FloatArray
    """The opposite corner."""
    solids: tuple[str, ...]
    """Names of its geoms."""
    angles_rad: Mapping[str, float]
    """The pose that the skin is bound in, by joint; others are at zero."""
    head_radius_m: float
    """Of a circle with the head's circumference."""
    mesh: SculptedMesh
    garments: Mapping[str, Garment]
    ages_months: FloatArray
    """Ages that the body is sculpted at."""
    fullness_m: FloatArray
    """How much fuller than its solids the body is at each of these ages, shape (ages, n)."""
    head: SculptedHead


@cache
def template_mesh(hands: str) -> Sculpture:
    """Return the skin for a kind of hands: `mitten` or `five_finger`."""
    with np.load(FOLDER / f"{hands}.npz") as archive, np.load(FOLDER / "head.npz") as head:
        return assembled({name: archive[name] for name in archive.files}, {name: head[name] for name in head.files})


def assembled(arrays: Mapping[str, npt.NDArray[Any]], head: Mapping[str, npt.NDArray[Any]]) -> Sculpture:
    """Return a sculpture from its arrays, by their names in the files."""
    parts = tuple(map(str, arrays["parts"]))
    mesh = {field.name: _fixed(arrays[field.name]) for field in fields(SculptedMesh) if field.name != "offsets_m"}
    return Sculpture(
        parts=parts,
        parents=MappingProxyType(
            {part: str(name) for part, name in zip(parts, arrays["parents"], strict=True) if name}
        ),
        **{name: _fixed(arrays[name]) for name in ("origins_m", "turns", "low_m", "high_m")},
        solids=tuple(map(str, arrays["solids"])),
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
        head=_head(head),
    )


def _garment(arrays: Mapping[str, npt.NDArray[Any]], index: int) -> Garment:
    across = np.column_stack((arrays["pattern"], arrays["shades"][index] / 255))
    return Garment(
        is_covered=(arrays["covers"] >> index & 1).astype(bool),
        lifts_m=arrays["lifts_50um"][index] * 5e-5,
        texcoords=_fixed(across),
    )


def _head(arrays: Mapping[str, npt.NDArray[Any]]) -> SculptedHead:
    names = ("verts_m", "newborn_m", "faces", "texcoords", "half_axes_m", "eye_m")
    return SculptedHead(
        **{name: _fixed(arrays[name]) for name in names},
        closing_m=MappingProxyType({side: _fixed(arrays[f"closing_{side}_m"]) for side in ("left", "right")}),
        eye_radius_m=float(arrays["eye_radius_m"]),
    )


def _fixed(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """Return whole numbers as indices and others in double precision, read-only."""
    fixed = array.astype(np.float64 if array.dtype.kind == "f" else np.intp)
    fixed.flags.writeable = False
    return fixed

"""Processing of a mesh file into the shape of a toy."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.errors import ToyError
from mimoc.toys.model import FloatArray, Mesh, Solid, join
from mimoc.toys.toys4k.cleaning import clean, only_used
from mimoc.toys.toys4k.convex import MOST_FACES, box_of, convex_parts, hull, is_soup, is_thin, thin_box
from mimoc.toys.toys4k.decimating import decimate
from mimoc.toys.toys4k.resting import TOPS, planes, set_down
from mimoc.toys.toys4k.subprocesses import WorkerError, run_worker
from mimoc.toys.toys4k.winding import Surface, face_outwards, from_both_sides

VERSION = 2
"""Version of the processing, incremented with each change of its results."""
MOST_FACES_SEEN = 5000
MOST_FACES_READ = 4_000_000
READING_LIMIT_S = 90
LEAST_FILLED = 0.05
"""Smallest volume of a closed mesh, relative to that of its convex parts: below it, the mesh is a thin shell."""


@dataclass(frozen=True, slots=True, eq=False)
class Shape:
    """The result of processing a mesh file. Lengths are in units of the longest side."""

    looks: Mesh
    solids: tuple[Solid, ...]
    volume: float


def process(content: bytes, kind: str) -> Shape:
    """Return the shape of a toy, standing on z = 0 in its most stable upright pose and centred over the origin.

    Args:
        content: Content of a mesh file.
        kind: Its format; see `mimoc.toys.toys4k.dataset.FORMATS`.

    Raises:
        ToyError: If it cannot be used; the message is a predicate without its subject, the mesh.
    """
    try:
        arrays = run_worker("read", content, kind, MOST_FACES_READ, limit_s=READING_LIMIT_S)
    except WorkerError as error:
        raise ToyError(str(error)) from None
    surface = face_outwards(clean(arrays["vertices"], arrays["faces"]))
    whole = bool(surface.closed.all())
    once, looks = _looks(surface)
    flat = is_thin(looks.vertices)
    if flat:
        parts = [thin_box(looks.vertices)]
    elif is_soup(len(surface.mesh.faces), int(surface.shells.max()) + 1):
        parts = [hull(decimate(once, MOST_FACES).vertices)]
    else:
        parts = convex_parts(decimate(once, MOST_FACES), simple=whole and not surface.shells.any())
    volume = _volume(surface.mesh if whole else None, parts)
    rotation = _rotation(parts, TOPS[kind])
    low, high = np.min(looks.vertices @ rotation.T, axis=0), np.max(looks.vertices @ rotation.T, axis=0)
    scale, middle = 1 / float((high - low).max()), (low + high) / 2
    ground = min(float((part.vertices @ rotation[2]).min()) for part in parts)
    placed = [_placed(part, rotation, np.array([middle[0], middle[1], ground]), scale) for part in parts]
    return Shape(
        looks=_placed(looks, rotation, np.array([middle[0], middle[1], low[2]]), scale),
        solids=tuple(box_of(part) if flat else Solid("mesh", (), mesh=part) for part in placed),
        volume=volume * scale**3,
    )


def _looks(surface: Surface) -> tuple[Mesh, Mesh]:
    """Return a decimated mesh, and a copy of it whose open shells are visible from both sides."""
    mesh = surface.mesh
    whole, torn = (only_used(mesh.vertices, mesh.faces[which]) for which in (surface.closed, ~surface.closed))
    share = MOST_FACES_SEEN / max(len(whole.faces) + 2 * len(torn.faces), MOST_FACES_SEEN)
    whole, torn = (decimate(part, max(int(len(part.faces) * share), 1)) for part in (whole, torn))
    return join([whole, torn]), join([whole, from_both_sides(torn)])


def _volume(closed: Mesh | None, parts: Sequence[Mesh]) -> float:
    """Return the volume of a closed mesh, or of its convex parts if the mesh is open, a thin shell or overlapping."""
    of_parts = math.fsum(part.volume for part in parts)
    within = closed.volume if closed else 0.0
    return min(within, of_parts) if within >= LEAST_FILLED * of_parts else of_parts


def _rotation(parts: Sequence[Mesh], top: str) -> FloatArray:
    """Return the rotation that places parts of equal density on a face of their common convex hull."""
    weights = np.array([part.volume for part in parts])
    centre = weights @ np.stack([_centre(part) for part in parts]) / weights.sum()
    corners = np.concatenate([part.vertices for part in parts])
    around = parts[0] if len(parts) == 1 else hull(corners, len(corners))
    return set_down(*planes(around.vertices, around.faces, centre), top)


def _centre(part: Mesh) -> FloatArray:
    """Return the centre of mass of the volume of a convex mesh, from tetrahedra between its faces and its middle."""
    middle = part.vertices.mean(axis=0)
    a, b, c = (part.vertices[part.faces[:, corner]] - middle for corner in range(3))
    volumes = np.einsum("ij,ij->i", np.cross(a, b), c)
    return middle + volumes @ (a + b + c) / (4 * volumes.sum())


def _placed(mesh: Mesh, rotation: FloatArray, origin: FloatArray, scale: float) -> Mesh:
    return Mesh((mesh.vertices @ rotation.T - origin) * scale, mesh.faces)

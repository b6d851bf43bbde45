"""Touch receptors: the forces of contacts on the points of the skin, and how each is shared among those around it."""

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import mujoco
import numpy as np
import numpy.typing as npt
from scipy.spatial import KDTree

from mimoc.components.senses.touch import SkinEntry
from mimoc.runtime.sense import FloatArray, IntArray

SIGNS = np.array([[-1.0], [1.0]])  # By side: the normal of a contact points out of its first geom, into its second.
FIELDS = ("geom", "efc_address", "frame", "dim", "dist", "pos")
"""Fields of `MjData.contact` that say where contacts are, and where their forces."""
AXES = np.arange(3)  # Axes of a contact: its normal, then two tangents.
FIELD_RADIUS = 2.0  # Radius of a receptive field, in spacings of the receptors.
BODY_OFFSET = np.array([1e3, 0.0, 0.0])
"""Offset from each body to the next in scaled space, in field radii: their receptors do not meet."""
CELL_STRIDES = np.array([1e8, 1e4, 1.0])  # Turns the corner of a cell into one number.
AROUND = np.array([-1.0, 0.0, 1.0])  # Steps from a cell to itself and its neighbours, along each coordinate.


class ContactForces(NamedTuple):
    """The forces of contacts on m surfaces that have skin."""

    bodies: IntArray  # The body of each surface, shape (m,).
    places_m: FloatArray  # Where on the surface, shape (m, 3), in the world.
    forces_n: FloatArray  # Shape (m, 3), in the world.
    normal_forces_n: FloatArray  # Along the inward normals, shape (m, 1); never negative.
    contacts: IntArray  # Which contact each is of, shape (m,).


def skin_body_of_geoms(bodies: IntArray, model: mujoco.MjModel) -> IntArray:
    """Return the body of each geom, or 0, the world, where it is none of *bodies*, shape (ngeom + 1,).

    The last entry is for what has no geom: there MuJoCo's index is -1.
    """
    geom_bodies = np.append(model.geom_bodyid, 0).astype(np.intp)
    return np.where(np.isin(geom_bodies, bodies), geom_bodies, 0)


def contact_forces(contact: Any, efc_force: FloatArray, body_of_geom: IntArray) -> ContactForces | None:
    """Return the forces of contacts on bodies with skin, or None if nothing touches them.

    The cost is in the number of calls of NumPy, of which `take` is the fastest of its kind.

    Args:
        contact: `MjData.contact` of a simulation with elliptic friction cones, or `FIELDS` of that of many, joined; an
            address of -1 is of geoms that are near each other, but do not touch.
        efc_force: The forces of all constraints that they point at.
        body_of_geom: What `skin_body_of_geoms` returns, of each infant whose geoms they point at.
    """
    bodies = body_of_geom.take(contact.geom)
    addresses = contact.efc_address
    if -1 in addresses.tolist():
        bodies[addresses < 0] = 0
    index, side = bodies.nonzero()
    if not index.size:
        return None
    inwards = (contact.frame.take(index, 0) * SIGNS.take(side, 0)).reshape(-1, 3, 3)
    forces_n = efc_force.take(addresses.take(index)[:, None] + AXES, mode="clip")
    if 1 in contact.dim.tolist():  # Without friction, the rows that follow belong to the next contact.
        forces_n[contact.dim[index] == 1, 1:] = 0.0
    half_gaps_m = contact.dist.take(index)[:, None] * 0.5  # A contact lies midway between the two surfaces.
    places_m = contact.pos.take(index, 0) + half_gaps_m * inwards[:, 0]
    return ContactForces(bodies[index, side], places_m, rotated(forces_n, inwards), forces_n[:, :1], index)


def rotated(vectors: FloatArray, axes: FloatArray) -> FloatArray:
    """Return each of some vectors, shape (m, 3), times its matrix, shape (m, 3, 3)."""
    return (vectors[:, None] @ axes)[:, 0]


@dataclass(frozen=True)
class Receptors:
    """The n receptors of a skin, and an index of those near a place.

    The index is over a scaled space, in which all bodies are far apart and the unit is the field radius of the body. It
    is cut into cells, cubes of one unit.
    """

    names: npt.NDArray[np.str_]  # The body of each receptor, shape (n,).
    bodies: IntArray  # The same, as the model's ids, shape (n,).
    points_m: FloatArray  # Shape (n, 3), in the frames of their bodies.
    scale_per_m: FloatArray  # Units of scaled space in a metre, by body of the model, shape (nbody, 1).
    offsets: FloatArray  # Origins of the frames of the bodies in scaled space, shape (nbody, 3).
    scaled: FloatArray
    """The receptors in scaled space, shape (3, n + 1); the last, which pads tables, is infinitely far."""
    cells: FloatArray  # The cells that have receptors within one unit, shape (c,), sorted.
    neighbours: IntArray
    """The receptors within one unit of any place in a cell, padded with n, shape (c + 1, k); the last row is all n."""

    @functools.cached_property
    def tree(self) -> KDTree:
        """The receptors in scaled space, to find the nearest one at any distance; few skins ever need it."""
        return KDTree(self.scaled[:, :-1].T)

    def share(self, bodies: IntArray, places_m: FloatArray, loads: FloatArray) -> tuple[IntArray, FloatArray]:
        """Share each load among the receptors around it: return these (m, k), and the share of each (width, m, k).

        A share falls linearly with the distance, to 0 at the field radius. A load beyond that of all receptors goes to
        the nearest one. The shares of a load sum to it.

        Args:
            bodies: The body that each load is on, shape (m,).
            places_m: Where, shape (m, 3), in the frames of the bodies.
            loads: What to share, shape (m, width).
        """
        scaled = places_m * self.scale_per_m.take(bodies, 0) + self.offsets.take(bodies, 0)
        cells = self.cells.searchsorted(_cells(scaled))  # The receptors of a wrong cell are out of range.
        receptors = self.neighbours.take(cells, 0)
        away = self.scaled.take(receptors, 1) - scaled.T[:, :, None]
        weights = np.maximum(1.0 - np.sqrt(np.add.reduce(away * away)), 0.0)
        sums = np.add.reduce(weights, 1)
        if 0.0 in sums.tolist():
            alone = sums == 0.0
            receptors[alone, 0] = self.tree.query(scaled[alone])[1]
            weights[alone, 0] = 1.0
            sums[alone] = 1.0
        return receptors, (loads.T / sums)[:, :, None] * weights

    def nearest(self, bodies: IntArray, places_m: FloatArray, loads: FloatArray) -> tuple[IntArray, FloatArray]:
        """Give each load to the nearest receptor: return these (m, 1), and the loads (width, m, 1); see `share`."""
        receptors: Any
        _, receptors = self.tree.query(places_m * self.scale_per_m[bodies] + self.offsets[bodies])
        return receptors[:, None], loads.T[:, :, None]


def bind_receptors(skin: Sequence[SkinEntry], points_m: FloatArray, model: mujoco.MjModel) -> Receptors:
    """Return the receptors of some bodies of a model: body by body, in the order of the model.

    The points are in the frames of the bodies, one body of *skin* after the other, shape (n, 3).
    """
    ends = np.cumsum([part.points for part in skin])
    by_body = zip(skin, np.split(points_m, ends[:-1]), strict=True)
    by_id = [(model.body(part.body).id, part, points) for part, points in by_body if part.points]
    parts = sorted(by_id, key=lambda part: part[0])
    described = tuple((body, part.body, part.points, part.spacing_m) for body, part, _ in parts)
    return _receptors(described, np.concatenate([points for *_, points in parts]).tobytes(), model.nbody)


@functools.lru_cache(maxsize=16)
def _receptors(parts: tuple[tuple[int, str, int, float], ...], points: bytes, nbody: int) -> Receptors:
    """Return the receptors of some bodies, which all infants of one bundle share.

    Each body has its number, its name, how many points there are, as bytes of an array of shape (n, 3), and their
    spacing in [m].
    """
    points_m = np.frombuffer(points).reshape(-1, 3)
    counts = [count for _, _, count, _ in parts]
    names = np.repeat([name for _, name, _, _ in parts], counts)
    bodies = np.repeat([body for body, *_ in parts], counts)
    for array in (names, bodies):
        array.flags.writeable = False
    scale_per_m = np.zeros((nbody, 1))
    for body, _, _, spacing_m in parts:
        scale_per_m[body] = 1 / (FIELD_RADIUS * spacing_m)
    offsets = np.arange(nbody, dtype=float)[:, None] * BODY_OFFSET
    scaled = points_m * scale_per_m[bodies] + offsets[bodies]
    cells, neighbours = _neighbours(scaled)
    padded = np.ascontiguousarray(np.vstack([scaled, np.full(3, np.inf)]).T)
    return Receptors(names, bodies, points_m, scale_per_m, offsets, padded, cells, neighbours)


def _neighbours(scaled: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the cells that have receptors within one unit, and a table of these.

    A cell and a receptor near it are one integer, the receptor in its lowest bits: a plain sort brings them in order.
    """
    count = len(scaled)
    bits, corners = count.bit_length(), np.floor(scaled)
    gaps = np.stack([scaled - (corners - 1.0) - 1.0, np.zeros_like(scaled), corners + 1.0 - scaled], axis=2)
    near = _of_three(gaps * gaps).reshape(count, -1) < 1.0
    steps = _of_three((AROUND * CELL_STRIDES[:, None])[None]).astype(np.int64).ravel()
    keys_of_points = (_cells(scaled).astype(np.int64) << bits) + np.arange(count)
    pairs = np.sort((keys_of_points[:, None] + (steps << bits))[near])
    cells, receptors = pairs >> bits, pairs & ((1 << bits) - 1)
    firsts = np.flatnonzero(np.append(True, cells[1:] != cells[:-1]))
    counts = np.diff(firsts, append=len(cells))
    table = np.full((len(firsts) + 1, counts.max()), count)
    places = np.arange(len(cells)) + np.repeat(np.arange(len(firsts)) * table.shape[1] - firsts, counts)
    table.ravel()[places] = receptors
    return cells[firsts].astype(float), table


def _of_three(terms: FloatArray) -> FloatArray:
    """Return the sums of a term of each coordinate, all with all: from shape (n, 3, m) to (n, m, m, m)."""
    return terms[:, 0, :, None, None] + terms[:, 1, None, :, None] + terms[:, 2, None, None, :]


def _cells(scaled: FloatArray) -> FloatArray:
    return np.floor(scaled) @ CELL_STRIDES

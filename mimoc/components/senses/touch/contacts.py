"""The forces of all contacts at once, from both sides, on the bodies that have skin."""

from typing import Any, NamedTuple

import mujoco
import numpy as np

from mimoc.runtime.sense import FloatArray, IntArray

SIGNS = np.array([[-1.0], [1.0]])
"""By side: the normal of a contact points out of its first geom, into its second."""
FIELDS = ("geom", "efc_address", "frame", "dim", "dist", "pos")
"""What of `MjData.contact` says where contacts are, and where their forces."""
AXES = np.arange(3)
"""Of a contact: its normal, then two tangents."""


class ContactForces(NamedTuple):
    """The forces of contacts on m surfaces that have skin."""

    bodies: IntArray
    """The body of each surface, shape (m,)."""
    places_m: FloatArray
    """Where on the surface, shape (m, 3), in the world."""
    forces_n: FloatArray
    """Shape (m, 3), in the world."""
    normal_forces_n: FloatArray
    """Along the inward normals, shape (m, 1); never negative."""
    contacts: IntArray
    """Which contact each is of, shape (m,)."""


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
    bodies, addresses = body_of_geom.take(contact.geom), contact.efc_address
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

"""The forces of all contacts at once, as the bodies feel them that they act on."""

from typing import NamedTuple

import mujoco
import numpy as np

from mimoc.senses.sense import FloatArray, IntArray

SIGNS = np.array([[-1.0], [1.0]])
"""By side: a contact's normal points out of its first geom, which is pushed back, into its second."""
AXES = np.arange(3)
"""Of a contact: its normal, then two tangents."""


class Pushes(NamedTuple):
    """The m sides of contacts on which there is somebody who feels."""

    bodies: IntArray
    """What is pushed, shape (m,)."""
    places_m: FloatArray
    """Where on its surface, shape (m, 3), in the world."""
    forces_n: FloatArray
    """Shape (m, 3), in the world."""
    pressures_n: FloatArray
    """Along the normals, inwards, shape (m, 1); never negative."""


def feeling_bodies(bodies: IntArray, model: mujoco.MjModel) -> IntArray:
    """Return the body of each geom, or 0, the world, if it is none of *bodies*, shape (ngeom + 1,).

    The last is for what has no geom: there MuJoCo's index is -1.
    """
    geom_bodies = np.append(model.geom_bodyid, 0).astype(np.intp)
    return np.where(np.isin(geom_bodies, bodies), geom_bodies, 0)


def find_pushes(data: mujoco.MjData, feeling: IntArray) -> Pushes | None:
    """Return what contacts do to bodies, or None if nothing touches them.

    What counts here is how few calls of NumPy it takes, and `take` is the fastest of its kind.

    Args:
        data: A simulation with elliptic friction cones.
        feeling: The body of each geom, as `feeling_bodies` returns it.
    """
    contact = data.contact
    bodies, addresses = feeling.take(contact.geom), contact.efc_address
    if -1 in addresses.tolist():  # These are near each other, but do not touch.
        bodies[addresses < 0] = 0
    index, side = bodies.nonzero()
    if not index.size:
        return None
    inwards = (contact.frame.take(index, 0) * SIGNS.take(side, 0)).reshape(-1, 3, 3)
    forces_n = data.efc_force.take(addresses.take(index)[:, None] + AXES, mode="clip")
    if 1 in contact.dim.tolist():  # These have no friction; what follows is the next one's.
        forces_n[contact.dim[index] == 1, 1:] = 0.0
    half_gaps_m = contact.dist.take(index)[:, None] * 0.5  # A contact lies midway between the two surfaces.
    places_m = contact.pos.take(index, 0) + half_gaps_m * inwards[:, 0]
    return Pushes(bodies[index, side], places_m, rotated(forces_n, inwards), forces_n[:, :1])


def rotated(vectors: FloatArray, axes: FloatArray) -> FloatArray:
    """Return each of some vectors, shape (m, 3), times its matrix, shape (m, 3, 3)."""
    return (vectors[:, None] @ axes)[:, 0]

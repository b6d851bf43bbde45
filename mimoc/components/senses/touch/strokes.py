"""How fast contacts slide over the skin, by which slow stroking is felt."""

import mujoco
import numpy as np

from mimoc.base.geometry.rotations import cross
from mimoc.components.senses.touch.adaptation import stroking
from mimoc.components.senses.touch.contacts import ContactForces
from mimoc.runtime.sense import FloatArray, IntArray


class Stroking:
    """What of the pressure of contacts is stroking."""

    def __init__(self, model: mujoco.MjModel, hairless: frozenset[int]):
        """Find which skin feels it: not that of the bodies that are hairless."""
        self._body_of_geom = np.append(model.geom_bodyid, 0).astype(np.intp)
        self._roots = model.body_rootid.astype(np.intp)
        self._is_hairy = ~np.isin(np.arange(model.nbody), list(hairless))

    def __call__(self, data: mujoco.MjData, forces: ContactForces, pressures_n: FloatArray) -> FloatArray:
        """Return the pressure of m contacts, and what of it is stroking, shape (m, 2); *pressures_n* has it twice."""
        bodies = self._body_of_geom.take(data.contact.geom.take(forces.contacts, 0))
        normals = data.contact.frame.take(forces.contacts, 0)[:, :3]
        speeds_m_s = sliding_speeds(data, bodies, self._roots, forces.places_m, normals)
        shares = np.where(self._is_hairy.take(forces.bodies), stroking(speeds_m_s), 0.0)
        return pressures_n * np.stack([np.ones_like(shares), shares], axis=1)


def sliding_speeds(
    data: mujoco.MjData, bodies: IntArray, roots: IntArray, places_m: FloatArray, normals: FloatArray
) -> FloatArray:
    """Return how fast two bodies slide over each other at some places, shape (m,), [m/s].

    MuJoCo's `cvel` of a body is about the centre of mass of its tree, c: v = v_c + w x (p - c).

    Args:
        data: The state.
        bodies: Both bodies of each contact, shape (m, 2).
        roots: The root of the tree of each body of the model, shape (nbody,).
        places_m: Shape (m, 3), in the world.
        normals: Shape (m, 3).
    """
    turning, moving = np.split(data.cvel.take(bodies, 0), 2, axis=-1)
    away_m = places_m[:, None] - data.subtree_com.take(roots.take(bodies), 0)
    velocities = moving + cross(turning, away_m)
    relative = velocities[:, 1] - velocities[:, 0]
    across = relative - (relative * normals).sum(axis=1, keepdims=True) * normals
    return np.sqrt((across * across).sum(axis=1))

"""What kernels read of contacts: one flat list for all worlds."""

from typing import Any

import mujoco_warp as mjw
import warp as wp


@wp.struct
class Contacts:
    """The contacts of all worlds, c of them at most."""

    count: wp.array[int]
    """How many there are, shape (1,)."""
    world: wp.array[int]
    """Shape (c,), as are all that follow."""
    geoms: wp.array[wp.vec2i]
    dist: wp.array[float]
    pos: wp.array[wp.vec3]
    frame: wp.array[wp.mat33]
    dim: wp.array[int]
    rows: wp.array2d[int]
    """Rows of constraints, -1 for near misses, shape (c, rows)."""
    force: wp.array2d[float]
    """Forces of the constraints, shape (worlds, constraints)."""


def contacts_of(data: mjw.Data) -> Any:
    """Return the contacts of all worlds for kernels."""
    contact, found = data.contact, Contacts()
    found.count, found.world, found.geoms = data.nacon, contact.worldid, contact.geom
    found.dist, found.pos, found.frame = contact.dist, contact.pos, contact.frame
    found.dim, found.rows, found.force = contact.dim, contact.efc_address, data.efc.force
    return found


@wp.func
def presses(contacts: Contacts, index: int) -> bool:
    """Return whether a contact has a force; the others are near misses, or beyond the end of the list."""
    return index < contacts.count[0] and contacts.rows[index, 0] >= 0


@wp.func
def force_of(contacts: Contacts, index: int) -> wp.vec3:
    """Return the force of a contact, along its normal and two tangents."""
    world = contacts.world[index]
    force = wp.vec3(0.0, 0.0, 0.0)
    for axis in range(3):
        if axis < contacts.dim[index]:
            force[axis] = contacts.force[world, contacts.rows[index, axis]]
    return force

"""What kernels read of contacts: one flat list for all worlds."""

from typing import Any

import mujoco_warp as mjw
import torch
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
    contact, contacts = data.contact, Contacts()
    contacts.count, contacts.world, contacts.geoms = data.nacon, contact.worldid, contact.geom
    contacts.dist, contacts.pos, contacts.frame = contact.dist, contact.pos, contact.frame
    contacts.dim, contacts.rows, contacts.force = contact.dim, contact.efc_address, data.efc.force
    return contacts


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


class PressingGroups:
    """Finds which groups of geoms press on which in all worlds; see `Worlds.pressing`."""

    def __init__(self, data: mjw.Data):
        """Read the contacts of some data."""
        self._data, self._contacts = data, contacts_of(data)
        self._known: dict[int, tuple[torch.Tensor, wp.array, wp.array]] = {}

    def __call__(self, group_of_geom: torch.Tensor) -> torch.Tensor:
        """Return it, shape (worlds, g, g), in memory that the next call with the same groups writes to."""
        if id(group_of_geom) not in self._known:
            count = int(group_of_geom.max()) + 1
            pressing = wp.zeros((self._data.nworld, count, count), dtype=wp.bool)
            self._known[id(group_of_geom)] = group_of_geom, wp.from_torch(group_of_geom.int()), pressing
        _, groups, pressing = self._known[id(group_of_geom)]
        pressing.zero_()
        wp.launch(_press, self._data.naconmax, [self._contacts, groups], [pressing])
        return wp.to_torch(pressing)


@wp.kernel(enable_backward=False)
def _press(contacts: Contacts, groups: wp.array[int], pressing: wp.array3d[wp.bool]):
    index = wp.tid()
    if presses(contacts, index):
        first, second = groups[contacts.geoms[index][0]], groups[contacts.geoms[index][1]]
        if first >= 0 and second >= 0:
            pressing[contacts.world[index], first, second] = True
            pressing[contacts.world[index], second, first] = True

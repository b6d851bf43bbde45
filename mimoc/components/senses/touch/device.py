"""Touch on a device: one thread for each contact of any infant, which adds its force to the skin that it presses on."""

# A kernel is in a language of its own, which only looks like Python.
# pyright: reportArgumentType=false, reportAttributeAccessIssue=false, reportIndexIssue=false, reportOperatorIssue=false
# pyright: reportAssignmentType=false, reportGeneralTypeIssues=false

from typing import Any

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.spaces import Box

from mimoc.base.errors import UnknownNameError
from mimoc.components.senses.touch.receptors import skin_body_of_geoms
from mimoc.runtime.device.signals import DeviceError, DeviceSetup
from mimoc.runtime.sense import FloatArray

IN_BODY, IN_WORLD, NORMAL = range(3)
QUANTITIES = {"force_vector": IN_BODY, "force_vector_global": IN_WORLD, "normal": NORMAL}  # What is felt of a contact.
KINDS = ("bodies", "points")
"""How touch can be told: by the sum of all forces on each body that has skin, or by the forces at all its points."""


@wp.struct
class Contacts:
    """The contacts of all worlds, c of them at most."""

    count: wp.array[int]  # How many there are, shape (1,).
    world: wp.array[int]  # Shape (c,), as are all that follow.
    geoms: wp.array[wp.vec2i]
    dist: wp.array[float]
    pos: wp.array[wp.vec3]
    frame: wp.array[wp.mat33]
    dim: wp.array[int]
    rows: wp.array2d[int]  # Rows of constraints, -1 for near misses, shape (c, rows).
    force: wp.array2d[float]  # Forces of the constraints, shape (worlds, constraints).


def contacts_of(data: mjw.Data) -> Any:
    """Return the contacts of all worlds for kernels."""
    contact, contacts = data.contact, Contacts()
    contacts.count, contacts.world, contacts.geoms = data.nacon, contact.worldid, contact.geom
    contacts.dist, contacts.pos, contacts.frame = contact.dist, contact.pos, contact.frame
    contacts.dim = contact.dim
    contacts.rows = contact.efc_address
    contacts.force = data.efc.force
    return contacts


class TouchReader:
    """Touch of all infants: forces at places on the skin, which share them as `Receptors` does."""

    def __init__(self, setup: DeviceSetup):
        """Find the places on each infant: all points, or one on each body, which has all that presses on the body.

        Raises:
            UnknownNameError: If there is no such way to tell of touch.
        """
        if setup.touch not in KINDS:
            raise UnknownNameError("way to tell of touch", setup.touch, KINDS)
        touches: list[Any] = [infant.senses["touch"] for infant in setup.infants]
        if touches[0].stroked:
            raise DeviceError("slow stroking is not felt on a device: leave 'ct' out of senses.touch.channels")
        model = setup.infants[0].model
        entry = setup.infants[0].manifest.senses.touch
        skin = touches[0].receptors.bodies
        self.width = touches[0].width
        self._body = setup.body.int()
        points_m = np.stack([touch.receptors.points_m for touch in touches])
        places = skin
        self._place_of_point = np.arange(len(skin))
        is_nearest = entry.response == "nearest"
        if setup.touch == "bodies":
            places, self._place_of_point = np.unique(skin, return_inverse=True)
            points_m = np.zeros((len(touches), len(places), 3))
            is_nearest = True
        self._size = len(places) * self.width
        channels = touches[0].channels
        self.bodies = np.tile(places, len(channels)) if channels else np.repeat(places, self.width)
        """The body in which each number is felt, shape (n,), of which `width` make a force."""
        self._sample = torch.zeros((len(setup.body), self._size), device=setup.body.device)
        box = touches[0].spaces["touch"]
        self.spaces = {"touch": Box(box.low.flat[0], box.high.flat[0], self.bodies.shape, np.float32)}
        self._quantity, self._sharing = QUANTITIES[entry.quantity], wp.vec2i(self.width, int(is_nearest))
        first, last = (np.searchsorted(places, np.arange(model.nbody), side) for side in ("left", "right"))
        self._geoms = wp.array(skin_body_of_geoms(skin, model), dtype=int)
        self._range = wp.array(np.stack([first, last], 1), wp.vec2i)
        self._points = wp.array(points_m, wp.vec3)
        self._scales = wp.array([touch.receptors.scale_per_m[:, 0] for touch in touches], dtype=float)

    def __call__(self, data: mjw.Data) -> torch.Tensor:
        """Return what is felt now, shape (worlds, n), in memory that the next call writes to."""
        self._sample.zero_()
        skin = [wp.from_torch(self._body), self._geoms, self._range, self._points, self._scales]
        inputs = [contacts_of(data), *skin, self._quantity, self._sharing, data.xpos, data.xmat]
        wp.launch(_share, (data.naconmax, 2), inputs, [wp.from_torch(self._sample)])
        return self._sample

    def start(self, sample: FloatArray) -> FloatArray:
        """Return what it tells of a sample of all points of one infant."""
        sums = np.zeros((self._size // self.width, self.width))
        np.add.at(sums, self._place_of_point, sample.reshape(-1, self.width))
        return sums.ravel()


bind = TouchReader


@wp.func
def _load(contacts: Contacts, index: int, inward: wp.mat33, quantity: int, world_from_body: wp.mat33) -> wp.vec3:
    """Return what is felt of a contact, whose axes are rows, the first into the side that feels."""
    force = wp.vec3(0.0, 0.0, 0.0)
    for axis in range(3):
        if axis < contacts.dim[index]:
            force[axis] = contacts.force[contacts.world[index], contacts.rows[index, axis]]
    if quantity == wp.static(NORMAL):
        return wp.vec3(force[0], 0.0, 0.0)
    in_world = wp.transpose(inward) @ force
    if quantity == wp.static(IN_WORLD):
        return in_world
    return wp.transpose(world_from_body) @ in_world


@wp.kernel(enable_backward=False)
def _share(
    contacts: Contacts,
    body_of_world: wp.array[int],
    body_of_geom: wp.array[int],
    points_of_body: wp.array[wp.vec2i],
    points: wp.array2d[wp.vec3],
    scales: wp.array2d[float],
    quantity: int,
    width_and_nearest: wp.vec2i,
    xpos: wp.array2d[wp.vec3],
    xmat: wp.array2d[wp.mat33],
    sample: wp.array2d[float],
):
    index, side = wp.tid()
    if index >= contacts.count[0] or contacts.rows[index, 0] < 0:
        return  # Beyond the end of the list, or a near miss, which has no force.
    body = body_of_geom[contacts.geoms[index][side]]
    world = contacts.world[index]
    if body == 0:
        return
    mine = body_of_world[world]
    rotation = xmat[world, body]
    inward = wp.float32(2 * side - 1) * contacts.frame[index]
    surface = contacts.pos[index] + 0.5 * contacts.dist[index] * wp.transpose(inward) @ wp.vec3(1.0, 0.0, 0.0)
    place = wp.transpose(rotation) @ (surface - xpos[world, body])  # A contact lies midway between the two surfaces.
    load = _load(contacts, index, inward, quantity, rotation)
    span = points_of_body[body]
    scale = scales[mine, body]
    total = float(0.0)
    least = float(1.0e30)
    nearest = int(span[0])
    for point in range(span[0], span[1]):
        away = wp.length(points[mine, point] - place) * scale
        total += wp.max(1.0 - away, 0.0)
        if away < least:
            least = away
            nearest = point
    for point in range(span[0], span[1]):
        share = float(point == nearest)
        if width_and_nearest[1] == 0 and total > 0.0:
            share = wp.max(1.0 - wp.length(points[mine, point] - place) * scale, 0.0) / total
        if share > 0.0:
            for number in range(width_and_nearest[0]):
                wp.atomic_add(sample, world, point * width_and_nearest[0] + number, load[number] * share)

"""Touch on a device: one thread for each contact of any infant, which adds its force to the skin that it presses on."""

from collections.abc import Sequence
from typing import Any, Protocol

import mujoco_warp as mjw
import numpy as np
import warp as wp
from gymnasium.spaces import Box

from mimoc.errors import UnknownNameError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.arrays import put
from mimoc.runtime.warp.contacts import Contacts, contacts_of, force_of, presses
from mimoc.runtime.warp.signals import DeviceSetup
from mimoc.senses.sense import FloatArray, IntArray
from mimoc.senses.touch.contacts import skin_body_of_geoms

IN_BODY, IN_WORLD, NORMAL = range(3)
QUANTITIES = {"force_vector": IN_BODY, "force_vector_global": IN_WORLD, "normal": NORMAL}
"""What is felt of a contact."""


class Feeling(Protocol):
    """A way to tell of what touches the skin."""

    bodies: IntArray
    """The body in which each number is felt, shape (n,)."""
    width: int
    """How many numbers make a force."""

    def __call__(self, model: mjw.Model, data: mjw.Data, sample: wp.array) -> None:
        """Write what is felt now, shape (worlds, n)."""
        ...

    def start(self, sample: FloatArray) -> FloatArray:
        """Return what it tells of a sample of all points of one infant."""
        ...


class BodySums:
    """The sum of all forces on each body that has skin, in the order of the bodies."""

    def __init__(self, infants: Sequence[InfantEnv], body_of_world: wp.array):
        """Find the bodies."""
        touch, model = _touch(infants[0]), infants[0].model
        self.width, self._quantity = touch.width, _quantity(infants[0])
        felt, self._part_of_point = np.unique(touch.receptors.bodies, return_inverse=True)
        self.bodies = np.repeat(felt, self.width)
        box = touch.spaces["touch"]
        self.spaces = {"touch": Box(box.low.flat[0], box.high.flat[0], self.bodies.shape, np.float32)}
        parts = np.full(model.nbody, -1)
        parts[felt] = np.arange(len(felt))
        self._geoms, self._parts = _skin(infants[0]), put(parts, wp.int32)

    def __call__(self, model: mjw.Model, data: mjw.Data, sample: wp.array) -> None:
        """Write the sums."""
        sample.zero_()
        inputs = [contacts_of(data), self._geoms, self._parts, self._quantity, self.width, data.xmat]
        wp.launch(_sum_by_body, (data.naconmax, 2), inputs, [sample])

    def start(self, sample: FloatArray) -> FloatArray:
        """Return the sums of a sample of all points."""
        sums = np.zeros((len(self.bodies) // self.width, self.width))
        np.add.at(sums, self._part_of_point, sample.reshape(-1, self.width))
        return sums.ravel()


class AllPoints:
    """The forces at all points of the skin, shared as `Receptors` shares them."""

    def __init__(self, infants: Sequence[InfantEnv], body_of_world: wp.array):
        """Find the points of each infant."""
        touch, model = _touch(infants[0]), infants[0].model
        self.bodies, self.width, self._quantity = touch.bodies, touch.width, _quantity(infants[0])
        self._sharing = wp.vec2i(touch.width, int(infants[0].manifest.senses.touch.response == "nearest"))
        on = touch.receptors.bodies
        first, last = (np.searchsorted(on, np.arange(model.nbody), side) for side in ("left", "right"))
        self._geoms, self._range = _skin(infants[0]), put(np.stack([first, last], 1), wp.vec2i)
        self._points = put([_touch(each).receptors.points_m for each in infants], wp.vec3)
        self._scales = put([_touch(each).receptors.scale_per_m[:, 0] for each in infants])
        self._body = body_of_world

    def __call__(self, model: mjw.Model, data: mjw.Data, sample: wp.array) -> None:
        """Write the forces."""
        sample.zero_()
        skin = [self._body, self._geoms, self._range, self._points, self._scales]
        inputs = [contacts_of(data), *skin, self._quantity, self._sharing, data.xpos, data.xmat]
        wp.launch(_share_among_points, (data.naconmax, 2), inputs, [sample])

    def start(self, sample: FloatArray) -> FloatArray:
        """Return the sample itself."""
        return sample


KINDS = {"bodies": BodySums, "points": AllPoints}
"""How touch can be told."""


def feeling(kind: str, infants: Sequence[InfantEnv], body_of_world: wp.array) -> Feeling:
    """Return the touch of all infants.

    Raises:
        UnknownNameError: If there is no such way to tell of it.
    """
    if kind not in KINDS:
        raise UnknownNameError("way to tell of touch", kind, KINDS)
    return KINDS[kind](infants, body_of_world)


def bind(setup: DeviceSetup) -> Feeling:
    """Return the touch of all infants, told as the environment was asked to."""
    return feeling(setup.touch, setup.infants, setup.body)


def _touch(infant: InfantEnv) -> Any:
    return infant.senses["touch"]


def _quantity(infant: InfantEnv) -> int:
    entry: Any = infant.manifest.senses.touch
    return QUANTITIES[entry.quantity]


def _skin(infant: InfantEnv) -> wp.array:
    return put(skin_body_of_geoms(_touch(infant).receptors.bodies, infant.model), wp.int32)


@wp.func
def _inward(contacts: Contacts, index: int, side: int) -> wp.mat33:
    """Return the axes of a contact as rows, the first into the geom of a side."""
    if side == 0:
        return -1.0 * contacts.frame[index]
    return contacts.frame[index]


@wp.func
def _place(contacts: Contacts, index: int, side: int) -> wp.vec3:
    """Return where a contact is on the surface of one side: it lies midway between the two surfaces."""
    normal = wp.transpose(_inward(contacts, index, side)) @ wp.vec3(1.0, 0.0, 0.0)
    return contacts.pos[index] + 0.5 * contacts.dist[index] * normal


@wp.func
def _load(contacts: Contacts, index: int, side: int, quantity: int, world_from_body: wp.mat33) -> wp.vec3:
    """Return what is felt of a contact on one side."""
    force = force_of(contacts, index)
    if quantity == wp.static(NORMAL):
        return wp.vec3(force[0], 0.0, 0.0)
    in_world = wp.transpose(_inward(contacts, index, side)) @ force
    if quantity == wp.static(IN_WORLD):
        return in_world
    return wp.transpose(world_from_body) @ in_world


@wp.kernel(enable_backward=False)
def _sum_by_body(
    contacts: Contacts,
    body_of_geom: wp.array[int],
    parts: wp.array[int],
    quantity: int,
    width: int,
    xmat: wp.array2d[wp.mat33],
    sample: wp.array2d[float],
):
    index, side = wp.tid()
    if presses(contacts, index):
        body = body_of_geom[contacts.geoms[index][side]]
        if body > 0:
            world = contacts.world[index]
            load = _load(contacts, index, side, quantity, xmat[world, body])
            for number in range(width):
                wp.atomic_add(sample, world, parts[body] * width + number, load[number])


@wp.kernel(enable_backward=False)
def _share_among_points(
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
    width = width_and_nearest[0]
    if presses(contacts, index):
        body = body_of_geom[contacts.geoms[index][side]]
        if body > 0:
            world = contacts.world[index]
            mine = body_of_world[world]
            place = wp.transpose(xmat[world, body]) @ (_place(contacts, index, side) - xpos[world, body])
            load = _load(contacts, index, side, quantity, xmat[world, body])
            span, total = points_of_body[body], float(0.0)
            nearest = int(span[0])
            least = float(1.0e30)
            for point in range(span[0], span[1]):
                away = wp.length(points[mine, point] - place) * scales[mine, body]
                total += wp.max(1.0 - away, 0.0)
                if away < least:
                    least = away
                    nearest = point
            if width_and_nearest[1] == 1 or total == 0.0:
                for number in range(width):
                    wp.atomic_add(sample, world, nearest * width + number, load[number])
            else:
                for point in range(span[0], span[1]):
                    away = wp.length(points[mine, point] - place) * scales[mine, body]
                    if away < 1.0:
                        for number in range(width):
                            wp.atomic_add(sample, world, point * width + number, load[number] * (1.0 - away) / total)

"""The touch of many infants at once: one array expression over the contacts of all of them."""

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from mimoc.runtime.worlds import Worlds
from mimoc.senses.sense import FloatArray, IntArray, Sample, Sense
from mimoc.senses.touch.contacts import Contacts, forces_of, rotated
from mimoc.senses.touch.run import Touch


class TouchReader:
    """Reads the touch of k infants whose models have as many bodies and geoms as each other's.

    Infants of one bundle share their receptors, and the forces on them are shared out together.
    """

    def __init__(self, senses: Sequence[Touch]):
        """Join the touch of each infant."""
        self._first = first = senses[0]
        self._bodies, self._geoms = len(first.receptors.scale_per_m), len(first.body_of_geom)
        self._width = first.width
        self._size = len(first.receptors.bodies) * first.width
        table = np.stack([sense.body_of_geom for sense in senses])
        self._body_of_geom = np.where(table, table + np.arange(len(senses))[:, None] * self._bodies, 0).ravel()
        kinds = {id(sense.receptors): sense.receptors for sense in senses}
        numbers = {identity: number for number, identity in enumerate(kinds)}
        self._receptors = list(kinds.values())
        self._kinds = np.array([numbers[id(sense.receptors)] for sense in senses])

    def __call__(self, worlds: Worlds) -> Sequence[Sample]:
        """Return a sample of each."""
        samples: dict[int, Sample] = {}
        counts, contacts, efc_force = _joined(worlds.datas, self._geoms)
        forces = forces_of(contacts, efc_force, self._body_of_geom)
        if forces is None:
            return [np.zeros(self._size) for _ in worlds.datas]
        owners = np.repeat(np.arange(len(counts)), counts).take(forces.contacts)
        world_from_body = worlds.xmat.reshape(-1, 9).take(forces.bodies, 0).reshape(-1, 3, 3)
        places_m = rotated(forces.places_m - worlds.xpos.reshape(-1, 3).take(forces.bodies, 0), world_from_body)
        loads = self._first.quantity.read(forces, world_from_body)
        bodies = forces.bodies - owners * self._bodies
        for kind in range(len(self._receptors)):
            members = np.flatnonzero(self._kinds == kind)
            which = np.flatnonzero(self._kinds[owners] == kind)
            if which.size:
                places = np.searchsorted(members, owners[which])
                shared = self._shared(kind, len(members), places, bodies[which], places_m[which], loads[which])
                samples |= zip(members.tolist(), shared, strict=True)
        return [samples[index] if index in samples else np.zeros(self._size) for index in range(len(counts))]

    def _shared(
        self, kind: int, count: int, owners: IntArray, bodies: IntArray, places_m: FloatArray, loads: FloatArray
    ) -> NDArray[Any]:
        """Return what the receptors of infants of one kind measure, shape (count, size).

        Beyond the numbers of each infant there is room for the receptor that pads tables.
        """
        touch, row = self._first, self._size + self._width
        receptors, shares = touch.response(self._receptors[kind], bodies, places_m, loads)
        numbers = (receptors * self._width + owners[:, None] * row) + touch.quantity.columns
        felt = np.bincount(numbers.ravel(), shares.ravel(), count * row)
        return felt.reshape(count, row)[:, : self._size]


def join(senses: Sequence[Sense]) -> TouchReader | None:
    """Return what reads many infants, or None if their worlds differ in more than numbers."""
    touches = [sense for sense in senses if isinstance(sense, Touch)]
    sizes = {(len(touch.receptors.scale_per_m), len(touch.body_of_geom)) for touch in touches}
    return TouchReader(touches) if len(touches) == len(senses) and len(sizes) == 1 else None


def _joined(datas: Sequence[mujoco.MjData], geoms: int) -> tuple[list[int], Contacts, FloatArray]:
    """Return how many contacts each of k infants has, all of them, and all forces of constraints.

    Their geoms are those of the infant before and its own after each other, and so are their addresses of forces.

    Args:
        datas: The state of each.
        geoms: Length of the table of geoms of one infant.
    """
    contacts, forces = [data.contact for data in datas], [data.efc_force for data in datas]
    addresses = [contact.efc_address for contact in contacts]
    counts = [len(rows) for rows in addresses]
    starts = np.cumsum([0, *map(len, forces[:-1])])
    address, offset = np.concatenate(addresses), np.repeat(starts, counts)
    geom = (
        np.concatenate([contact.geom for contact in contacts])
        + np.repeat(np.arange(len(datas)) * geoms, counts)[:, None]
    )
    frame, dim, dist, pos = (
        np.concatenate([getattr(contact, name) for contact in contacts]) for name in ("frame", "dim", "dist", "pos")
    )
    joined = Contacts(geom, np.where(address < 0, -1, address + offset), frame, dim, dist, pos)
    return counts, joined, np.concatenate(forces)

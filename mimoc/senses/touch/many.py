"""The touch of many infants at once: one array expression over the contacts of all of them."""

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from mimoc.senses.joined import Simulations
from mimoc.senses.sense import FloatArray, IntArray, Observation, Sample, Sense
from mimoc.senses.touch.contacts import Contacts, forces_of, rotated
from mimoc.senses.touch.run import Touch


class JoinedTouch:
    """Touch of infants whose models have as many bodies and geoms as each other's.

    Infants of one bundle share their receptors, and the forces on them are shared out together.
    """

    def __init__(self, senses: Sequence[Touch]):
        """Join the touch of each infant."""
        self._senses, first = senses, senses[0]
        self._bodies, self._geoms = len(first.receptors.scale_per_m), len(first.body_of_geom)
        self._width = first.width
        self._size = len(first.receptors.bodies) * first.width
        self._body_of_geom = np.stack([each.body_of_geom for each in senses])
        kinds = {id(each.receptors): each.receptors for each in senses}
        numbers = {identity: number for number, identity in enumerate(kinds)}
        self._receptors, self._kinds = list(kinds.values()), np.array([numbers[id(each.receptors)] for each in senses])

    def read(self, simulations: Simulations, infants: Sequence[int]) -> Sequence[Sample]:
        """Return a sample of each."""
        chosen, felt = np.asarray(infants), dict[int, FloatArray]()
        counts, contacts, efc_force = _joined([simulations.datas[infant] for infant in infants], self._geoms)
        owners = np.repeat(np.arange(len(infants)), counts)
        shift = np.arange(len(infants))[:, None] * self._bodies
        table = self._body_of_geom[chosen]
        forces = forces_of(contacts, efc_force, np.where(table, table + shift, 0).ravel())
        if forces is None:
            return [np.zeros(self._size) for _ in infants]
        owners = owners.take(forces.contacts)
        xmat, xpos = (simulations.array(field, infants) for field in ("xmat", "xpos"))
        world_from_body = xmat.reshape(-1, 9).take(forces.bodies, 0).reshape(-1, 3, 3)
        places_m = rotated(forces.places_m - xpos.reshape(-1, 3).take(forces.bodies, 0), world_from_body)
        loads = self._senses[0].quantity.read(forces, world_from_body)
        bodies, kinds = forces.bodies - owners * self._bodies, self._kinds[chosen]
        for kind in np.unique(kinds).tolist():
            members = np.flatnonzero(kinds == kind)
            which = np.flatnonzero(kinds[owners] == kind)
            if which.size:
                places = np.searchsorted(members, owners[which])
                shared = self._shared(kind, len(members), places, bodies[which], places_m[which], loads[which])
                felt |= zip(members.tolist(), shared, strict=True)
        return [felt[index] if index in felt else np.zeros(self._size) for index in range(len(infants))]

    def observe(self, samples: Sequence[Sample]) -> Observation:
        """Return the samples within their bounds."""
        seen = np.empty((len(samples), self._size), np.float32)
        for sense, sample, row in zip(self._senses, samples, seen, strict=True):
            row[:] = sample
            sense.limit(row)
        return {"touch": seen}

    def _shared(
        self, kind: int, count: int, owners: IntArray, bodies: IntArray, places_m: FloatArray, loads: FloatArray
    ) -> NDArray[Any]:
        """Return what the receptors of infants of one kind measure, shape (count, size).

        Beyond the numbers of each infant there is room for the receptor that pads tables.
        """
        touch, row = self._senses[0], self._size + self._width
        receptors, shares = touch.response(self._receptors[kind], bodies, places_m, loads)
        numbers = (receptors * self._width + owners[:, None] * row) + touch.quantity.columns
        felt = np.bincount(numbers.ravel(), shares.ravel(), count * row)
        return felt.reshape(count, row)[:, : self._size]


def join(senses: Sequence[Sense]) -> JoinedTouch | None:
    """Return the touch of many infants, or None if one has noise, or their worlds differ in more than numbers."""
    touches = [sense for sense in senses if isinstance(sense, Touch)]
    sizes = {(len(touch.receptors.scale_per_m), len(touch.body_of_geom)) for touch in touches}
    return JoinedTouch(touches) if len(touches) == len(senses) and len(sizes) == 1 else None


def _joined(datas: Sequence[mujoco.MjData], geoms: int) -> tuple[list[int], Contacts, FloatArray]:
    """Return how many contacts each of k infants has, all of them, and all forces of constraints.

    Their geoms are those of the infant before and its own after each other, and so are their addresses of forces.

    Args:
        datas: The state of each.
        geoms: Length of the table of geoms of one infant.
    """
    contacts, forces = [data.contact for data in datas], [data.efc_force for data in datas]
    addresses = [each.efc_address for each in contacts]
    counts = [len(each) for each in addresses]
    starts = np.cumsum([0, *map(len, forces[:-1])])
    address, offset = np.concatenate(addresses), np.repeat(starts, counts)
    geom = np.concatenate([each.geom for each in contacts]) + np.repeat(np.arange(len(datas)) * geoms, counts)[:, None]
    frame, dim, dist, pos = (
        np.concatenate([getattr(each, name) for each in contacts]) for name in ("frame", "dim", "dist", "pos")
    )
    joined = Contacts(geom, np.where(address < 0, -1, address + offset), frame, dim, dist, pos)
    return counts, joined, np.concatenate(forces)

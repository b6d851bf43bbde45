"""The simulated worlds that a term reads: those of one infant, of many, or of all on a device, with one interface.

Every field of MuJoCo's `MjData` whose size never changes is an array with a leading axis of k infants:

    worlds.qpos     (k, nq)            one infant:  a view of its data, k = 1
    worlds.xpos     (k, nbody, 3)      many:        copies, stacked when a field is first asked for
    worlds.xmat     (k, nbody, 3, 3)   a device:    torch's views of MuJoCo Warp's data

and `worlds.xp` is the array library these belong to, by the Python array API standard.
"""

from collections.abc import Callable, Sequence
from typing import Any

import mujoco
import numpy as np

from mimoc.runtime.array_library import NUMPY

MATRICES = frozenset(("xmat", "ximat", "geom_xmat", "site_xmat", "cam_xmat"))
"""Fields whose rows are matrices, shape (3, 3), which MuJoCo stores flat."""

OF_CONSTRAINTS = (
    *("dof_island", "efc_", "efm_", "iacc", "iefc_", "ifrc_", "island_", "map_", "tendon_efc", "tree_island"),
)
"""What the names of arrays begin with whose size depends on the present contacts and other constraints."""


class Worlds:
    """Fields of the simulations of k infants by name, shape (k, ...), and what else terms can ask of them."""

    def __init__(
        self,
        xp: Any,
        read: Callable[[str], Any],
        pressing: Callable[[Any], Any],
        loads: Callable[[Any], Any],
        datas: Sequence[mujoco.MjData] = (),
    ):
        """Say how to read worlds.

        Args:
            xp: The array library.
            read: Returns a field by its name, shape (k, ...).
            pressing: See `pressing`.
            loads: See `loads`.
            datas: The simulations themselves, on the CPU, for what is no term.
        """
        self.datas = datas
        self.xp, self._read, self._pressing, self._loads = xp, read, pressing, loads

    def __getattr__(self, field: str) -> Any:
        """Return a field of `MjData`, which is read once."""
        if field.startswith("_"):
            raise AttributeError(field)
        array = self._read(field)
        setattr(self, field, array)
        return array

    def pressing(self, group_of_geom: Any) -> Any:
        """Return which groups of geoms press on which, shape (k, g, g), symmetric.

        Args:
            group_of_geom: The group of each geom, from 0 to g - 1, or -1 for none, shape (ngeom,).
        """
        return self._pressing(group_of_geom)

    def loads(self, group_of_geom: Any) -> Any:
        """Return the largest normal force of a contact on each group of geoms, shape (k, g), [N].

        Args:
            group_of_geom: See `pressing`.
        """
        return self._loads(group_of_geom)


def worlds_of_one(data: mujoco.MjData) -> Worlds:
    """Return the world of one infant: its arrays are views, which show every later state of the same data."""
    read = _reader(data, lambda field: getattr(data, field)[None])
    return Worlds(
        NUMPY,
        read,
        lambda group_of_geom: pressing_groups(data, group_of_geom)[None],
        lambda group_of_geom: largest_loads(data, group_of_geom)[None],
    )


def worlds_of_many(datas: Sequence[mujoco.MjData], read: Callable[[str], Any]) -> Worlds:
    """Return the worlds of k infants as they are now; *read* returns a field of all of them, shape (k, ...)."""

    def pressing(group_of_geom: Any) -> Any:
        return np.stack([pressing_groups(data, group_of_geom) for data in datas])

    def loads(group_of_geom: Any) -> Any:
        return np.stack([largest_loads(data, group_of_geom) for data in datas])

    return Worlds(NUMPY, _reader(datas[0], read), pressing, loads, datas)


def _reader(data: mujoco.MjData, read: Callable[[str], np.ndarray]) -> Callable[[str], np.ndarray]:
    """Return what reads fields whose sizes never change, matrices as such; others are an AttributeError."""

    def read_checked(field: str) -> np.ndarray:
        if field.startswith(OF_CONSTRAINTS) or not isinstance(getattr(data, field, None), np.ndarray):
            raise AttributeError(f"worlds have no array '{field}': see MjData for those whose size never changes")
        array = read(field)
        return array.reshape(*array.shape[:2], 3, 3) if field in MATRICES else array

    return read_checked


def pressing_groups(data: mujoco.MjData, group_of_geom: np.ndarray) -> np.ndarray:
    """Return which groups of geoms press on which in one world, shape (g, g); see `Worlds.pressing`.

    Contacts without a constraint are near, but exert no force.
    """
    count = int(group_of_geom.max(initial=-1)) + 1
    pressing = np.zeros((count, count), bool)
    first, second = group_of_geom.take(data.contact.geom[data.contact.efc_address >= 0]).T
    both = (first >= 0) & (second >= 0)
    pressing[first[both], second[both]] = pressing[second[both], first[both]] = True
    return pressing


def largest_loads(data: mujoco.MjData, group_of_geom: np.ndarray) -> np.ndarray:
    """Return the largest normal force of a contact on each group of geoms in one world, shape (g,), [N]."""
    loads, addresses = np.zeros(int(group_of_geom.max(initial=-1)) + 2), data.contact.efc_address
    touching = addresses >= 0
    if touching.any():
        forces_n = data.efc_force.take(addresses[touching])
        np.maximum.at(loads, group_of_geom.take(data.contact.geom[touching]), forces_n[:, None])
    return loads[:-1]

"""The simulated worlds that a term reads: those of one infant, of many, or of all on a device, with one interface.

Every field of MuJoCo's `MjData` whose size never changes is an array with a leading axis of k infants:

    worlds.qpos     (k, nq)            one infant:  a view of its data, k = 1
    worlds.xpos     (k, nbody, 3)      many:        copies, stacked when a field is first asked for
    worlds.xmat     (k, nbody, 3, 3)   a device:    torch's views of MuJoCo Warp's data

and `worlds.xp` is the array library these belong to, by the Python array API standard. On the CPU that is `NUMPY`:
NumPy with the names of the standard that version 1.26 lacks, and shorter ways for single infants. `numpy.take(a, i)`
passes a dispatcher that costs more than the reading itself for arrays as small as an infant's; `a.take(i)` does not.
"""

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np

NEW_NAMES = {
    "acos": "arccos",
    "asin": "arcsin",
    "atan": "arctan",
    "atan2": "arctan2",
    "concat": "concatenate",
    "permute_dims": "transpose",
    "pow": "power",
}  # The standard's names, with those of NumPy before version 2.


def _take(array: np.ndarray, indices: np.ndarray, /, *, axis: int | None = None) -> np.ndarray:
    return array.take(indices, axis)


def _sum(array: np.ndarray, /, *, axis: Any = None, keepdims: bool = False) -> np.ndarray:
    return array.sum(axis, keepdims=keepdims)


def _astype(array: np.ndarray, dtype: Any, /, *, copy: bool = True) -> np.ndarray:
    return array.astype(dtype, copy=copy)


def _matrix_transpose(array: np.ndarray, /) -> np.ndarray:
    return array.swapaxes(-1, -2)


def _vecdot(first: np.ndarray, second: np.ndarray, /) -> np.ndarray:
    return np.matmul(first[..., None, :], second[..., :, None])[..., 0, 0]


def _library() -> Any:
    names = {name: getattr(np, name) for name in np.__all__}
    names |= {name: getattr(np, former) for name, former in NEW_NAMES.items()}
    short = {"take": _take, "sum": _sum, "astype": _astype, "matrix_transpose": _matrix_transpose, "bool": np.bool_}
    names.setdefault("vecdot", _vecdot)  # NumPy 1.26 has none.
    return SimpleNamespace(**names | short)


NUMPY: Any = _library()  # What `Worlds.xp` is on the CPU.


def torch_library(beside: Any) -> tuple[Any, Callable[[Any], Any]]:
    """Return torch by the standard, and what copies NumPy's arrays to the device of a tensor.

    Real numbers get 32 bits there, whole ones 64, as torch indexes.
    """
    import array_api_compat.torch as library  # Comes with `mimoc[gpu]`.
    import torch

    def put(values: Any) -> Any:
        values = np.asarray(values)
        kind = {"f": torch.float32, "b": torch.bool}.get(values.dtype.kind, torch.int64)
        return torch.tensor(values, dtype=kind, device=beside.device)

    return library, put


MATRICES = frozenset(("xmat", "ximat", "geom_xmat", "site_xmat", "cam_xmat"))  # (3, 3); MuJoCo stores them flat.

OF_CONSTRAINTS = (
    *("dof_island", "efc_", "efm_", "iacc", "iefc_", "ifrc_", "island_", "map_", "tendon_efc", "tree_island"),
)  # Prefixes of arrays whose size depends on the present constraints.


class Worlds:
    """The state of k infants: fields by name, shape (k, ...), and contacts."""

    def __init__(
        self,
        xp: Any,
        read: Callable[[str], Any],
        pressing: Callable[[Any], Any],
        loads: Callable[[Any], Any],
        datas: Sequence[mujoco.MjData] = (),
    ):
        """Give access to worlds.

        Args:
            xp: The array library.
            read: Returns a field by its name, shape (k, ...).
            pressing: See the method.
            loads: See the method.
            datas: The simulations themselves, on the CPU, for what is no term.
        """
        self.datas = datas
        self.xp, self._read, self._pressing, self._loads = xp, read, pressing, loads

    def __getattr__(self, field: str) -> Any:
        if field.startswith("_"):
            raise AttributeError(field)
        array = self._read(field)
        setattr(self, field, array)
        return array

    def pressing(self, group_of_geom: Any) -> Any:
        """Return which groups of geoms press on which, shape (k, g, g), symmetric.

        *group_of_geom* is the group of each geom, from 0 to g - 1, or -1 for none, shape (ngeom,).
        """
        return self._pressing(group_of_geom)

    def loads(self, group_of_geom: Any) -> Any:
        """Return the largest normal force of a contact on each group of geoms, shape (k, g), [N]; see `pressing`."""
        return self._loads(group_of_geom)


def worlds_of_one(data: mujoco.MjData) -> Worlds:
    """Return the world of one infant; its arrays are views, which follow the data."""
    read = _reader(data, lambda field: getattr(data, field)[None])
    return Worlds(
        NUMPY,
        read,
        lambda group_of_geom: pressing_groups(data, group_of_geom)[None],
        lambda group_of_geom: largest_loads(data, group_of_geom)[None],
    )


def worlds_of_many(datas: Sequence[mujoco.MjData], read: Callable[[str], Any]) -> Worlds:
    """Return the present worlds of k infants; *read* returns a field of all, shape (k, ...)."""

    def pressing(group_of_geom: Any) -> Any:
        return np.stack([pressing_groups(data, group_of_geom) for data in datas])

    def loads(group_of_geom: Any) -> Any:
        return np.stack([largest_loads(data, group_of_geom) for data in datas])

    return Worlds(NUMPY, _reader(datas[0], read), pressing, loads, datas)


def _reader(data: mujoco.MjData, read: Callable[[str], np.ndarray]) -> Callable[[str], np.ndarray]:
    """Return a function that reads fields of constant size, and raises an AttributeError for others."""

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
    loads = np.zeros(int(group_of_geom.max(initial=-1)) + 2)
    addresses = data.contact.efc_address
    touching = addresses >= 0
    if touching.any():
        forces_n = data.efc_force.take(addresses[touching])
        np.maximum.at(loads, group_of_geom.take(data.contact.geom[touching]), forces_n[:, None])
    return loads[:-1]

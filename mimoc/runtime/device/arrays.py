"""Arrays on a device: views of MuJoCo Warp's for terms, without a copy, and what comes in and goes out of it."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from typing import Any

import array_api_compat.torch as array_library
import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp

from mimoc.base.errors import UnknownNameError
from mimoc.runtime.batch.gymnasium_forms import mixture_error
from mimoc.runtime.term import Put, Term, differing_field, stack_terms
from mimoc.runtime.worlds import Worlds


def flat(array: wp.array) -> torch.Tensor:
    """Return the numbers of an array as rows, shape (its first axis, the rest), in the same memory."""
    return wp.to_torch(array).view(array.shape[0], -1)


def to_device(values: Any, dtype: Any = wp.float32) -> wp.array:
    """Return a copy of values on Warp's present device."""
    return wp.array(np.ascontiguousarray(values), dtype=dtype)


def from_library(values: Any, shape: tuple[int, ...]) -> wp.array:
    """Return an array of 32-bit numbers of any library that knows DLPack, or NumPy's, as one of Warp's.

    Raises:
        ValueError: If it has another shape, or NumPy's is not finite.
    """
    if not isinstance(values, wp.array) and (isinstance(values, (np.ndarray, list, tuple)) or np.isscalar(values)):
        values = np.asarray(values, np.float32)
        if values.shape == shape and not np.isfinite(values).all():
            infant = int(np.flatnonzero(~np.isfinite(values).all(axis=1))[0])
            raise ValueError(f"expected finite actions, got {values[infant].tolist()} for infant {infant}")
    if tuple(values.shape) != shape:
        raise ValueError(f"expected finite actions of shape {shape}, got shape {tuple(values.shape)}")
    if isinstance(values, np.ndarray):
        return wp.array(values, dtype=wp.float32, device="cpu", copy=False)
    return values if isinstance(values, wp.array) else wp.from_dlpack(values)


KINDS: Mapping[str, Callable[[wp.array], Any]] = {
    "numpy": lambda array: array.numpy().copy(),
    "torch": lambda array: wp.to_torch(array),
    "warp": lambda array: array,
}
"""What observations and rewards can be given as: copies for NumPy, else the environment's own memory."""


def to_library(arrays: str) -> Callable[[wp.array], Any]:
    """Return what turns an array of Warp's into one of a library.

    Raises:
        UnknownNameError: If it is no such library.
    """
    if arrays not in KINDS:
        raise UnknownNameError("kind of arrays", arrays, KINDS)
    return KINDS[arrays]


class PressingGroups:
    """Finds which groups of geoms press on which in all worlds; see `Worlds.pressing`."""

    def __init__(self, data: mjw.Data):
        """Read the contacts of some data."""
        self._data, self._counts = data, dict[torch.Tensor, int]()

    def __call__(self, group_of_geom: torch.Tensor) -> torch.Tensor:
        """Return it, shape (worlds, g, g)."""
        if group_of_geom not in self._counts:  # To count them, the CPU waits for the device.
            self._counts[group_of_geom] = int(group_of_geom.max()) + 1
        count, contact = self._counts[group_of_geom], self._data.contact
        world, geoms, rows = map(wp.to_torch, (contact.worldid, contact.geom, contact.efc_address))
        groups = group_of_geom[geoms.long().clamp(min=0)]
        is_listed = torch.arange(len(world), device=world.device) < wp.to_torch(self._data.nacon)
        presses = is_listed & (rows[:, 0] >= 0) & (groups >= 0).all(dim=1)  # Near misses have no rows of constraints.
        pressing = torch.zeros(self._data.nworld * count**2 + 1, dtype=torch.bool, device=world.device)
        place = (world.long() * count + groups[:, 0]) * count + groups[:, 1]
        pressing[torch.where(presses, place, len(pressing) - 1)] = True  # The last one is of those that do not press.
        pressing = pressing[:-1].view(-1, count, count)
        return pressing | pressing.mT


def device_worlds(data: mjw.Data) -> Worlds:
    """Return the worlds of some data, for as long as its arrays keep their places in memory."""
    return Worlds(array_library, lambda field: wp.to_torch(getattr(data, field)), PressingGroups(data))


def put_on(device: wp.Device) -> Put:
    """Return what moves NumPy's arrays to a device: real numbers with 32 bits, whole ones with 64, as torch indexes."""
    place = wp.device_to_torch(device)

    def put(values: np.ndarray) -> torch.Tensor:
        kind = {"f": torch.float32, "b": torch.bool}.get(values.dtype.kind, torch.int64)
        return torch.as_tensor(values, dtype=kind, device=place)

    return put


def term_of_worlds(what: str, terms: Sequence[Term], body: wp.array) -> Term:
    """Return the term of all worlds, on their device.

    Args:
        what: What it is of, for errors.
        terms: Of the different bodies.
        body: Which of them lives in each world, shape (worlds,).

    Raises:
        MixtureError: If they look at different addresses.
    """
    for number, term in enumerate(terms):
        if field := differing_field([terms[0], term]):
            raise mixture_error(f"0 and {number}", f"the field '{field}' of the term of {what}")
    return stack_terms([terms[index] for index in body.numpy()], put_on(body.device))


def where_worlds(chosen: torch.Tensor, new: torch.Tensor, former: torch.Tensor) -> torch.Tensor:
    """Return the new values of chosen worlds, shape (worlds,), and the former ones of others, shape (worlds, ...)."""
    return torch.where(chosen.reshape(-1, *[1] * (former.ndim - 1)), new, former)


@contextmanager
def present(device: wp.Device) -> Iterator[None]:
    """Let a device be Warp's present one, where torch works on Warp's stream, so that each waits for the other."""
    with wp.ScopedDevice(device), torch.cuda.stream(wp.stream_to_torch(device)) if device.is_cuda else nullcontext():
        yield

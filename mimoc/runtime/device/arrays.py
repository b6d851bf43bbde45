"""Arrays on a device: torch's views of MuJoCo Warp's for terms, without a copy, and what comes in and goes out."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from typing import Any

import array_api_compat.torch as array_library
import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp

from mimoc.base.errors import UnknownNameError
from mimoc.runtime.gymnasium_forms import mixture_error
from mimoc.runtime.term import Term, differing_field, stack_terms
from mimoc.runtime.worlds import Worlds


def put(values: Any) -> torch.Tensor:
    """Copy to Warp's present device: real numbers with 32 bits, whole ones with 64, as torch indexes."""
    values = np.asarray(values)
    kind = {"f": torch.float32, "b": torch.bool}.get(values.dtype.kind, torch.int64)
    return torch.tensor(values, dtype=kind, device=wp.device_to_torch(wp.get_device()))


KINDS: Mapping[str, Callable[[torch.Tensor], Any]] = {
    "numpy": lambda array: array.cpu().numpy().copy(),
    "torch": lambda array: array,
    "warp": wp.from_torch,
}
"""What observations and rewards can be given as: copies for NumPy, else the environment's own memory."""


def to_library(arrays: str) -> Callable[[torch.Tensor], Any]:
    """Return the function that converts a tensor to an array of a library."""
    if arrays not in KINDS:
        raise UnknownNameError("kind of arrays", arrays, KINDS)
    return KINDS[arrays]


def device_worlds(data: mjw.Data) -> Worlds:
    """Return the worlds of some data, for as long as its arrays keep their places in memory."""
    counts: dict[torch.Tensor, int] = {}

    def count_of(group_of_geom: torch.Tensor) -> int:
        if group_of_geom not in counts:  # To count them, the CPU waits for the device.
            counts[group_of_geom] = int(group_of_geom.max()) + 1
        return counts[group_of_geom]

    def contacts(group_of_geom: torch.Tensor) -> tuple[torch.Tensor, ...]:
        contact = data.contact
        world, geoms, rows = map(wp.to_torch, (contact.worldid, contact.geom, contact.efc_address))
        is_listed = torch.arange(len(world), device=world.device) < wp.to_torch(data.nacon)
        groups = group_of_geom[geoms.long().clamp(min=0)]
        return world, groups, rows, is_listed & (rows[:, 0] >= 0)  # Near misses have no rows of constraints.

    def loads(group_of_geom: torch.Tensor) -> torch.Tensor:
        count = count_of(group_of_geom)
        forces_n = wp.to_torch(data.efc.force)
        world, groups, rows, touches = contacts(group_of_geom)
        worlds = world.long().clamp(min=0)
        first = rows[:, 0].long().clamp(min=0, max=forces_n.shape[1] - 1)
        normal_n = torch.where(touches, forces_n[worlds, first], 0.0)
        largest = forces_n.new_zeros(data.nworld * count + 1)  # The last one is of those in no group.
        for side in range(2):
            place = torch.where(touches & (groups[:, side] >= 0), worlds * count + groups[:, side], len(largest) - 1)
            largest.scatter_reduce_(0, place, normal_n, "amax")
        return largest[:-1].view(-1, count)

    def pressing(group_of_geom: torch.Tensor) -> torch.Tensor:
        count = count_of(group_of_geom)
        world, groups, _, touches = contacts(group_of_geom)
        presses = touches & (groups >= 0).all(dim=1)
        pairs = torch.zeros(data.nworld * count**2 + 1, dtype=torch.bool, device=world.device)
        place = (world.long() * count + groups[:, 0]) * count + groups[:, 1]
        pairs[torch.where(presses, place, len(pairs) - 1)] = True  # The last one is of those that do not press.
        pairs = pairs[:-1].view(-1, count, count)
        return pairs | pairs.mT

    return Worlds(array_library, lambda field: wp.to_torch(getattr(data, field)), pressing, loads, (data,))


def term_of_worlds(what: str, terms: Sequence[Term], body: torch.Tensor) -> Any:
    """Return the term of all worlds, on Warp's present device."""
    for number, term in enumerate(terms):
        if field := differing_field([terms[0], term]):
            raise mixture_error(f"0 and {number}", f"the field '{field}' of the term of {what}")
    return stack_terms([terms[index] for index in body.tolist()], put)


def where_worlds(chosen: torch.Tensor, new: torch.Tensor, former: torch.Tensor) -> torch.Tensor:
    """Select the new values, shape (worlds, ...), of chosen worlds, shape (worlds,), and the former ones of others."""
    return torch.where(chosen.reshape(-1, *[1] * (former.ndim - 1)), new, former)


@contextmanager
def present(device: wp.Device) -> Iterator[None]:
    """Make a device Warp's present one, with torch on Warp's stream, so that each waits for the other."""
    with wp.ScopedDevice(device), torch.cuda.stream(wp.stream_to_torch(device)) if device.is_cuda else nullcontext():
        yield


@contextmanager
def only_warnings() -> Iterator[None]:
    """Silence Warp's messages about kernels."""
    kept, wp.config.log_level = wp.config.log_level, wp.LOG_WARNING
    try:
        yield
    finally:
        wp.config.log_level = kept


def most_memory_mb(device: Any) -> float | None:
    """Return the most memory that PyTorch and Warp have had on one of Warp's devices; None on the CPU."""
    if not device.is_cuda:
        return None
    return (torch.cuda.max_memory_reserved(wp.device_to_torch(device)) + wp.get_mempool_used_mem_high(device)) / 1e6

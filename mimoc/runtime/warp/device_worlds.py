"""Worlds on a device, as terms read them: torch's views of MuJoCo Warp's arrays, which need no copy."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from typing import Any

import array_api_compat.torch as array_library
import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp

from mimoc.runtime.many.matching import MixtureError
from mimoc.runtime.term import Put, Term, differing_field, stack_terms
from mimoc.runtime.warp.contacts import PressingGroups
from mimoc.runtime.worlds import Worlds


def device_worlds(data: mjw.Data) -> Worlds:
    """Return the worlds of some data, for as long as its arrays keep their places in memory."""

    def read(field: str) -> Any:
        return wp.to_torch(getattr(data, field))

    return Worlds(array_library, read, PressingGroups(data))


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
            raise MixtureError(
                f"infants 0 and {number} cannot share a batch, because they differ in the field '{field}' of the term "
                f"of {what}; make a vector environment of each kind"
            )
    return stack_terms([terms[index] for index in body.numpy()], put_on(body.device))


def where_worlds(chosen: torch.Tensor, new: torch.Tensor, former: torch.Tensor) -> torch.Tensor:
    """Return the new values of chosen worlds, shape (worlds,), and the former ones of others, shape (worlds, ...)."""
    return torch.where(chosen.reshape(-1, *[1] * (former.ndim - 1)), new, former)


@contextmanager
def present(device: wp.Device) -> Iterator[None]:
    """Let a device be Warp's present one, where torch works on Warp's stream, so that each waits for the other."""
    with wp.ScopedDevice(device), torch.cuda.stream(wp.stream_to_torch(device)) if device.is_cuda else nullcontext():
        yield

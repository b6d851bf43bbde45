"""Worlds on a device, as terms read them: torch's views of MuJoCo Warp's arrays, which need no copy."""

from collections.abc import Sequence
from typing import Any

import array_api_compat.torch as array_library
import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp

from mimoc.runtime.many.matching import MixtureError
from mimoc.runtime.term import Put, Term, differing_field, stack_terms
from mimoc.runtime.worlds import Worlds


def device_worlds(data: mjw.Data) -> Worlds:
    """Return the worlds of some data, for as long as its arrays keep their places in memory."""

    def read(field: str) -> Any:
        return wp.to_torch(getattr(data, field))

    return Worlds(array_library, read, pressing=lambda group_of_geom: NotImplemented)


def put_on(device: wp.Device) -> Put:
    """Return what moves NumPy's arrays to a device: real numbers with 32 bits, whole ones with 64, as torch indexes."""
    place = wp.device_to_torch(device)

    def put(values: np.ndarray) -> torch.Tensor:
        kind = {"f": torch.float32, "b": torch.bool}.get(values.dtype.kind, torch.int64)
        return torch.as_tensor(values, dtype=kind, device=place)

    return put


def term_of_worlds(terms: Sequence[Term], body_of_world: Sequence[int]) -> Term:
    """Return the term of all worlds, on Warp's present device.

    Args:
        terms: Of the different bodies.
        body_of_world: Which of them lives in each world, shape (worlds,).

    Raises:
        MixtureError: If they look at different places.
    """
    if field := differing_field(terms):
        raise MixtureError(f"infants cannot share a batch, because they differ in {type(terms[0]).__name__}.{field}")
    return stack_terms([terms[body] for body in body_of_world], put_on(wp.get_device()))

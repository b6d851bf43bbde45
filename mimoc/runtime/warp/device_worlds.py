"""Worlds on a device, as terms read them: torch's views of MuJoCo Warp's arrays, which need no copy."""

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from typing import Any

import array_api_compat.torch as array_library
import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp

from mimoc.runtime.term import Put
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


@contextmanager
def present(device: wp.Device) -> Iterator[None]:
    """Let a device be Warp's present one, where torch works on Warp's stream, so that each waits for the other."""
    with wp.ScopedDevice(device), torch.cuda.stream(wp.stream_to_torch(device)) if device.is_cuda else nullcontext():
        yield

"""What Warp says, and how much memory of a device is in use."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import torch
import warp as wp


@contextmanager
def only_warnings() -> Iterator[None]:
    """Let Warp say nothing of its kernels meanwhile."""
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

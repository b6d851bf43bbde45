"""What infants need of a device: that it is there, and that all that they have can run on it."""

from collections.abc import Collection, Iterator
from typing import Any

import warp as wp

from mimoc.errors import MimocError
from mimoc.runtime.env import InfantEnv

SENSES = {"proprioception", "vestibular", "touch", "vision", "nothing"}
"""Senses that are there on a device."""


class DeviceError(MimocError):
    """Infants cannot live on a device, or what they do there went wrong."""


def find_device(name: str) -> Any:
    """Return one of Warp's devices.

    Raises:
        DeviceError: If it is not there.
    """
    try:
        return wp.get_device(name)
    except (ValueError, RuntimeError):
        there = ", ".join(device.alias for device in wp.get_devices())
        none = "" if wp.is_cuda_available() else " and no NVIDIA GPU with its driver"
        raise DeviceError(f"device '{name}' is not there; MuJoCo Warp finds {there}{none} on this machine") from None


def check_infant(infant: InfantEnv) -> None:
    """Check that all that an infant has is there on a device, whoever wrote it: what is not must not be ignored.

    Raises:
        DeviceError: If something is not.
    """
    name = infant.manifest.name
    for what, remedy in _missing(infant):
        raise DeviceError(f"infant '{name}' has {what}, which is not there on a device; {remedy}, or leave out device")


def _missing(infant: InfantEnv) -> Iterator[tuple[str, str]]:
    """Yield what is not there, and what to do about it."""
    manifest = infant.manifest
    for sense in _others(infant.senses, SENSES):
        yield f"the sense '{sense}'", "leave it out"
    if manifest.noise.delay_jitter_ms:
        yield "delays with jitter", "leave out delay_jitter_ms"


def _others(names: Collection[str], known: Collection[str]) -> list[str]:
    """Return the names that are not known."""
    return sorted(set(names) - set(known))

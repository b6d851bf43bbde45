"""What infants need of a device: that it is there, and that all that they have can run on it."""

from typing import Any

import warp as wp

from mimoc.errors import MimocError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.signals import device_part


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
        devices = ", ".join(device.alias for device in wp.get_devices())
        none = "" if wp.is_cuda_available() else " and no NVIDIA GPU with its driver"
        raise DeviceError(f"device '{name}' is not there; MuJoCo Warp finds {devices}{none} on this machine") from None


def check_infant(infant: InfantEnv) -> None:
    """Check that all that an infant has can run on a device, whoever wrote it: what cannot must not be ignored.

    Raises:
        DeviceError: If something cannot.
    """
    for sense, bound in infant.senses.items():
        if bound.term is None and not device_part(sense, bound):
            raise DeviceError(
                f"sense '{sense}' is not a term and has no device part: give it one (docs/own_sense.md), or leave out "
                "device"
            )
    if infant.manifest.noise.delay_jitter_ms:
        raise DeviceError(
            f"infant '{infant.manifest.name}' has delays with jitter, which are not there on a device; "
            "leave out delay_jitter_ms, or device"
        )

"""What torch computes on here."""

from importlib import import_module


def torch_devices() -> str:
    """Return what torch can compute on: `CUDA 12.8, NVIDIA H200`, say, or `CPU only`."""
    cuda = import_module("torch").cuda
    if not cuda.is_available():
        return "CPU only"
    names = dict.fromkeys(cuda.get_device_name(index) for index in range(cuda.device_count()))
    return f"CUDA {import_module('torch').version.cuda}, {', '.join(names)}"

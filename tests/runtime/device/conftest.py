import pytest
import warp as wp
from support.devices import WARP_DEVICE

from mimoc.runtime.device.signals import find_device


@pytest.fixture(scope="session", autouse=True)
def compiled_quickly():
    """Compile kernels for the CPU without optimising them, which takes half as long; for a GPU, that is unsafe."""
    kept = wp.config.optimization_level
    if WARP_DEVICE == "cpu":
        wp.config.optimization_level = 0
    yield
    wp.config.optimization_level = kept


@pytest.fixture(autouse=True)
def on_the_device():
    """Let the device be Warp's present one, for tests that make arrays and launch kernels themselves."""
    with wp.ScopedDevice(find_device(WARP_DEVICE)):
        yield

import pytest
from support.devices import WARP_DEVICE


@pytest.fixture(scope="session", autouse=True)
def compiled_quickly(kernels_compiled_quickly):
    """Compile kernels quickly for all tests here."""


@pytest.fixture(autouse=True)
def on_the_device():
    """Let the device be Warp's present one, for tests that make arrays and launch kernels themselves."""
    import warp

    from mimoc.runtime.device.signals import find_device

    with warp.ScopedDevice(find_device(WARP_DEVICE)):
        yield

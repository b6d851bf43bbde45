from collections.abc import Callable
from typing import Any

import pytest
from support.devices import DEVICE, WARP_DEVICE

import mimoc


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


@pytest.fixture
def make():
    """Return what makes infants on the device, which are closed in the end."""
    made: list[Any] = []

    def on_device(*arguments: Any, **options: Any) -> Any:
        made.append(mimoc.make_vec(*arguments, **{"device": DEVICE, **options}))
        return made[-1]

    yield on_device
    for envs in made:
        envs.close()


@pytest.fixture
def pair(make) -> Callable[..., Any]:
    """Return what makes the same infants on the device and on the CPU."""

    def on_both(sources: Any, count: int | None = None, **options: Any) -> Any:
        senses = {"senses": options["senses"]} if "senses" in options else {}
        return make(sources, count, **options), make(sources, count, device="cpu", threads=1, **senses)

    return on_both

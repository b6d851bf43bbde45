"""mimoc compiles simulated infants: from a YAML spec to plain MuJoCo XML and a Gymnasium environment."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from mimoc.registration import register_envs
from mimoc.version import __version__

if TYPE_CHECKING:
    from mimoc.bundle import Bundle, read_bundle, write_bundle
    from mimoc.errors import MimocError
    from mimoc.making import make
    from mimoc.pipeline import build, load_spec
    from mimoc.runtime import InfantEnv, torque_limits
    from mimoc.schema import InfantSpec

_HOMES = {
    "Bundle": "mimoc.bundle",
    "InfantEnv": "mimoc.runtime",
    "InfantSpec": "mimoc.schema",
    "MimocError": "mimoc.errors",
    "build": "mimoc.pipeline",
    "load_spec": "mimoc.pipeline",
    "make": "mimoc.making",
    "read_bundle": "mimoc.bundle",
    "torque_limits": "mimoc.runtime",
    "write_bundle": "mimoc.bundle",
}
"""Where each public name lives: they are imported when first used, so that each command loads only what it needs."""

__all__ = [
    "Bundle",
    "InfantEnv",
    "InfantSpec",
    "MimocError",
    "__version__",
    "build",
    "load_spec",
    "make",
    "read_bundle",
    "torque_limits",
    "write_bundle",
]

register_envs()


def __getattr__(name: str) -> Any:
    """Import a public name from its home."""
    if name not in _HOMES:
        raise AttributeError(f"module 'mimoc' has no attribute '{name}'")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """Return the public names, also those not imported yet."""
    return __all__

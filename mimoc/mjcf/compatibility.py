"""Other software that a bundle can be built for, and what has to be different for it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from mimoc.body import BodyTree
from mimoc.errors import UnknownNameError
from mimoc.mjcf.mimo.body import as_mimos
from mimoc.mjcf.mimo.model import fit_infant, fit_world
from mimoc.mjcf.scene import SceneTree


@dataclass(frozen=True, slots=True)
class CompatibilityTarget:
    """What has to be different in a model that some other software is to read."""

    body: Callable[[BodyTree], BodyTree]
    """Changes the body: its parts and their order."""
    infant: Callable[[SceneTree, str], SceneTree]
    """Changes the infant, before it is placed in a world; the other argument is its actuation model."""
    world: Callable[[SceneTree], SceneTree]
    """Changes the scene it is placed in."""


UNCHANGED = CompatibilityTarget(lambda tree: tree, lambda infant, model: infant, lambda scene: scene)
"""For mimoc alone."""
TARGETS: Mapping[str, CompatibilityTarget] = MappingProxyType(
    {"mimo": CompatibilityTarget(as_mimos, fit_infant, fit_world)}
)
"""By the name that users know."""


def find_target(name: str | None) -> CompatibilityTarget:
    """Return the target of that name; for None, one that changes nothing.

    Raises:
        UnknownNameError: If there is none.
    """
    if name is None:
        return UNCHANGED
    if name not in TARGETS:
        raise UnknownNameError("system to build for", name, TARGETS)
    return TARGETS[name]

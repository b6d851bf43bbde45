"""Other people's code that a bundle can be built for, and what it wants to be different."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from mimoc.body import BodyTree
from mimoc.errors import UnknownNameError
from mimoc.mjcf.mimo.body import as_mimos
from mimoc.mjcf.mimo.model import fit_infant, fit_world
from mimoc.mjcf.scene import SceneTree


@dataclass(frozen=True, slots=True)
class Convention:
    """What some code wants of a model that mimoc alone would write otherwise."""

    body: Callable[[BodyTree], BodyTree]
    """Of the body: its parts and their order."""
    infant: Callable[[SceneTree, str], SceneTree]
    """Of the infant, in no world yet; the other argument is its actuation model."""
    world: Callable[[SceneTree], SceneTree]
    """Of the world it is in."""


OWN = Convention(lambda tree: tree, lambda infant, model: infant, lambda scene: scene)
"""As mimoc has it."""
CONVENTIONS: Mapping[str, Convention] = MappingProxyType({"mimo": Convention(as_mimos, fit_infant, fit_world)})
"""By the name that users know."""


def find_convention(name: str | None) -> Convention:
    """Return the convention of that name, mimoc's own for None.

    Raises:
        UnknownNameError: If there is none.
    """
    if name is None:
        return OWN
    if name not in CONVENTIONS:
        raise UnknownNameError("system to build for", name, CONVENTIONS)
    return CONVENTIONS[name]

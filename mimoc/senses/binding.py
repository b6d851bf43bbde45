"""Senses: each is bound to a model once, then reads arrays."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.kinds import function_of
from mimoc.senses import SENSES
from mimoc.senses.nothing import nothing
from mimoc.senses.sense import Sense


def bind_senses(
    bundle: Bundle, model: mujoco.MjModel, former: Mapping[str, Sense] = MappingProxyType({})
) -> dict[str, Sense]:
    """Return the senses of an infant by name; one that has none observes nothing.

    Args:
        bundle: The infant.
        model: Its model.
        former: Its senses in the scene that it was in before; they are taken along, or closed.

    Raises:
        RenderingError: If it sees, and there is no OpenGL here.
    """
    taken = {name: sense for name, sense in former.items() if sense.follow(model)}
    for name in former.keys() - taken.keys():
        former[name].close()
    names = [name for name, entry in bundle.manifest.senses if entry is not None]
    return {name: taken.get(name) or bind_sense(name, bundle, model) for name in names} or {"nothing": nothing()}


def bind_sense(name: str, bundle: Bundle, model: mujoco.MjModel) -> Any:
    """Return one of the senses that an infant has; see `bind_senses`."""
    return function_of(SENSES[name].run, "bind")(getattr(bundle.manifest.senses, name), model, bundle)

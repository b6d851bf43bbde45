"""Senses: each is bound to a model once, then reads arrays."""

from collections.abc import Callable, Mapping
from typing import Any

import mujoco

from mimoc.runtime.senses.nothing import Nothing
from mimoc.runtime.senses.proprioception import bind_proprioception
from mimoc.runtime.senses.sense import Sense
from mimoc.runtime.senses.vestibular import bind_vestibular
from mimoc.schema.manifest import ActuationEntry, Manifest

SENSES: Mapping[str, Callable[[Any, ActuationEntry, mujoco.MjModel], Sense]] = {
    "proprioception": bind_proprioception,
    "vestibular": bind_vestibular,
}
"""By kind: from the entry in the manifest and the model to a sense."""


def bind_senses(manifest: Manifest, model: mujoco.MjModel) -> dict[str, Sense]:
    """Return the senses of an infant by name; one that has none observes nothing."""
    senses = {name: SENSES[name](entry, manifest.actuation, model) for name, entry in manifest.senses if entry}
    return senses or {"nothing": Nothing()}


__all__ = ["SENSES", "Sense", "bind_senses"]

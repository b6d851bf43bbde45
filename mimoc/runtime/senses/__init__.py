"""Senses: each is bound to a model once, then reads arrays."""

from collections.abc import Callable, Mapping
from typing import Any

import mujoco

from mimoc.runtime.senses.proprioception import bind_proprioception
from mimoc.runtime.senses.sense import Sense
from mimoc.runtime.senses.vestibular import bind_vestibular
from mimoc.schema.manifest import ActuationEntry

SENSES: Mapping[str, Callable[[Any, ActuationEntry, mujoco.MjModel], Sense]] = {
    "proprioception": bind_proprioception,
    "vestibular": bind_vestibular,
}
"""By kind: from the entry in the manifest and the model to a sense."""

__all__ = ["SENSES", "Sense"]

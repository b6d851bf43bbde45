"""The spaces of an environment, which never change."""

import copy
from collections.abc import Mapping
from typing import Any

import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.spaces import Box, Dict

from mimoc.base.errors import MimocError
from mimoc.runtime.actuation import Actuation
from mimoc.runtime.sense import Sense
from mimoc.runtime.task import Task
from mimoc.runtime.voice import HIGH, LOW


def action_space(actuation: Actuation, has_voice: bool = False) -> Any:
    """Return the space of actions: one command for each commanded actuator, and those of a voice."""
    limits = [(actuation.low, actuation.high), *([(LOW, HIGH)] if has_voice else [])]
    low, high = (np.concatenate(ends).astype(np.float32) for ends in zip(*limits, strict=True))
    return Box(low, high, dtype=np.float32)


def observation_space(senses: Mapping[str, Sense], task: Task) -> Dict:
    """Return the space of what the senses and the task give."""
    return Dict({name: space for part in (*senses.values(), task) for name, space in part.spaces.items()})


def with_limit(spec: EnvSpec | None, *limits: int | None) -> EnvSpec | None:
    """Return what Gymnasium says of an environment, with the control steps after which its episodes are truncated."""
    given = [limit for limit in (spec and spec.max_episode_steps, *limits) if limit is not None]
    if spec is None or not given:
        return spec
    limited = copy.copy(spec)
    limited.max_episode_steps = min(given)
    return limited


def check_same_space(wanted: Any, given: Dict) -> None:
    """Check that observations have kept their space."""
    for name in sorted(wanted.keys() | given.keys()):
        if wanted.get(name) != given.get(name):
            raise MimocError(f"the space of the observation '{name}' changes with age or scene; it must not")

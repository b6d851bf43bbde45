"""The spaces of an environment, which never change, and what Gymnasium says of it."""

import copy
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from gymnasium.envs.registration import EnvSpec
from gymnasium.spaces import Box, Dict

from mimoc.base.errors import MimocError
from mimoc.runtime.actuation import Actuation
from mimoc.runtime.sense import Sense
from mimoc.runtime.sound import VOICE_HIGH, VOICE_LOW
from mimoc.runtime.task import Task


def action_space(actuation: Actuation, has_voice: bool = False) -> Any:
    """Return the space of actions: one command for each commanded actuator, and those of a voice."""
    limits = [(actuation.low, actuation.high), *([(VOICE_LOW, VOICE_HIGH)] if has_voice else [])]
    low, high = (np.concatenate(ends).astype(np.float32) for ends in zip(*limits, strict=True))
    return Box(low, high, dtype=np.float32)


def observation_space(senses: Mapping[str, Sense], task: Task) -> Dict:
    """Return the space of what the senses and the task give."""
    return Dict({name: space for part in (*senses.values(), task) for name, space in part.spaces.items()})


def limited_spec(limits: Callable[[Any], Iterable[int | None]]) -> Any:
    """Return the property `spec` of an environment, in which the limits of its episodes are `max_episode_steps`."""

    def spec_of(env: Any) -> EnvSpec | None:
        spec = getattr(env, "_spec", None)
        given = [limit for limit in (spec and spec.max_episode_steps, *limits(env)) if limit is not None]
        if spec is None or not given:
            return spec
        limited = copy.copy(spec)
        limited.max_episode_steps = min(given)
        return limited

    return property(spec_of, lambda env, spec: setattr(env, "_spec", spec))


def check_same_space(wanted: Any, given: Dict) -> None:
    """Check that observations have kept their space."""
    for name in sorted(wanted.keys() | given.keys()):
        if wanted.get(name) != given.get(name):
            raise MimocError(f"the space of the observation '{name}' changes with age or scene; it must not")

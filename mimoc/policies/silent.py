"""Policies of infants with a voice that command none: they are silent."""

from typing import Any

import numpy as np

from mimoc.policies.policy import Policy
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import FloatArray, Observation
from mimoc.runtime.voice import HIGH, LOW


class Silent:
    """A policy whose last two commands, those of the voice, are 0 if it has none for them."""

    def __init__(self, policy: Policy, joints: int):
        """Take a policy, with all that it has besides; *joints* is the number of commands that are not the voice's."""
        self._policy, self._joints = policy, joints

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the action, shape (n + 2,)."""
        return with_silence(self._policy(generator, observation), self._joints)

    def __getattr__(self, name: str) -> Any:
        if name == "_policy":
            raise AttributeError(name)
        return getattr(self._policy, name)


def with_silence(actions: Any, joints: int) -> Any:
    """Return actions, shape (..., n), with a silent voice behind them, unless they have commands for it."""
    if actions.shape[-1] != joints:
        return actions
    return np.concatenate([actions, np.zeros((*actions.shape[:-1], len(LOW)), actions.dtype)], axis=-1)


def limits_of(env: Infant) -> tuple[FloatArray, FloatArray]:
    """Return the smallest and the largest commands of an infant, those of its voice included."""
    low, high = env.actuation.low, env.actuation.high
    if env.manifest.actuation.voice is None:
        return low, high
    return np.concatenate([low, LOW]), np.concatenate([high, HIGH])

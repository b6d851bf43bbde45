"""What a policy is."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import Observation

Policy = Callable[[np.random.Generator, Observation], np.ndarray]
"""Returns the action for an observation, shape (n,); all random numbers come from the generator.

It can have a method `metrics()`, which returns numbers for the summary of a run, by name with the unit: `hand_error_m`;
`steps_per_episode`, the control steps after which its episodes end, as in its training; and `reset()`, which is called
whenever an episode begins, for a policy that remembers what it sensed.
"""
BatchPolicy = Callable[[Sequence[np.random.Generator], Any], Any]
"""Returns the actions of k infants, shape (k, n), for a generator of each and their observations; row i is what
`Policy` returns for infant i. Of infants on a device, the arrays are of the library of their observations.

It can have a method `reset(rows)`, a boolean array of shape (k,): the episodes of these infants begin anew.
"""
PolicyMaker = Callable[[InfantEnv], Policy]
"""Returns the policy for an environment."""


def metrics_of(policy: Policy) -> Mapping[str, float]:
    """Return the numbers that a policy tells of a run; none for a policy that has no `metrics`."""
    metrics = getattr(policy, "metrics", None)
    return metrics() if metrics else {}


def start_again(policy: Policy) -> None:
    """Let a policy begin an episode; one without `reset` remembers nothing of the last."""
    reset = getattr(policy, "reset", None)
    if reset:
        reset()


def begin_rows(policy: BatchPolicy, rows: Any) -> None:
    """Let a policy of many begin the episodes of some rows; see `start_again`."""
    reset = getattr(policy, "reset", None)
    if reset:
        reset(rows)


def episode_limit_of(policy: Policy) -> float:
    """Return the control steps after which a policy's episodes end: infinity for one that does not say so."""
    return getattr(policy, "steps_per_episode", None) or math.inf

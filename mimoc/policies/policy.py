"""What a policy is."""

from collections.abc import Callable, Mapping

import numpy as np

from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import Observation

Policy = Callable[[np.random.Generator, Observation], np.ndarray]
"""Returns the action for an observation, shape (n,); all random numbers come from the generator.

It can have a method `metrics()`, which returns numbers for the summary of a run, by name with the unit: `hand_error_m`.
"""
PolicyMaker = Callable[[InfantEnv], Policy]
"""Returns the policy for an environment."""


def metrics_of(policy: Policy) -> Mapping[str, float]:
    """Return the numbers that a policy tells of a run; none for a policy that has no `metrics`."""
    metrics = getattr(policy, "metrics", None)
    return metrics() if metrics else {}

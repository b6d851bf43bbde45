"""A policy that draws every command uniformly from its range."""

import numpy as np

from mimoc.policies.policy import Policy
from mimoc.runtime.env import InfantEnv


def bind(env: InfantEnv) -> Policy:
    """Return the policy for an environment."""
    low, high = env.actuation.low, env.actuation.high
    return lambda generator, observation: generator.uniform(low, high).astype(np.float32)

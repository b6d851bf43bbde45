"""A policy that commands nothing."""

import numpy as np

from mimoc.policies.policy import Policy
from mimoc.runtime.env import InfantEnv


def bind(env: InfantEnv) -> Policy:
    """Return the policy for an environment."""
    action = np.clip(0.0, env.actuation.low, env.actuation.high).astype(np.float32)
    return lambda generator, observation: action

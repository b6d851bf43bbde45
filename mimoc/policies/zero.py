"""A policy that commands nothing."""

import numpy as np

from mimoc.policies.policy import Batch, BatchPolicy, Policy
from mimoc.runtime.infant import Infant


def bind(env: Infant) -> Policy:
    """Return the policy for an environment."""
    action = np.clip(0.0, env.actuation.low, env.actuation.high).astype(np.float32)
    return lambda generator, observation: action


def bind_many(batch: Batch) -> BatchPolicy:
    """Return the policy for many infants."""
    actions = batch.actions(batch.put(np.clip(0.0, *batch.limits())))
    return lambda generators, observations: actions

"""A policy that draws every command uniformly from its range."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from mimoc.policies.policy import Batch, BatchPolicy, Policy
from mimoc.runtime.infant import Infant


def bind(env: Infant) -> Policy:
    """Return the policy for an environment."""
    low, high = env.actuation.low, env.actuation.high
    return lambda generator, observation: generator.uniform(low, high).astype(np.float32)


def bind_many(batch: Batch) -> BatchPolicy:
    """Return the policy for many infants."""
    low, high = batch.limits()

    def act(generators: Sequence[np.random.Generator], observations: Any) -> Any:
        rows = zip(generators, low, high, strict=True)
        return batch.actions(batch.draw([generator.uniform(*limits) for generator, *limits in rows]))

    return act

"""What a policy is."""

from collections.abc import Callable

import numpy as np

from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import Observation

Policy = Callable[[np.random.Generator, Observation], np.ndarray]
"""Returns the action on an observation, shape (n,)."""
PolicyMaker = Callable[[InfantEnv], Policy]
"""Returns the policy for an environment."""

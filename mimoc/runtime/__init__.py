"""The runtime: from a bundle to a Gymnasium environment."""

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.limits import torque_limits

__all__ = ["InfantEnv", "torque_limits"]

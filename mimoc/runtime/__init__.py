"""From a bundle to a running Gymnasium environment."""

from mimoc.runtime.env import InfantEnv, make

__all__ = ["InfantEnv", "make"]

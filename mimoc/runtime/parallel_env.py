"""PettingZoo's view of several infants in one world."""

from typing import Any

from pettingzoo import ParallelEnv

from mimoc.runtime.world_env import WorldEnv


class InfantsParallelEnv(WorldEnv, ParallelEnv[str, Any, Any]):
    """Several infants in one world, as a PettingZoo `ParallelEnv`; see `WorldEnv`."""

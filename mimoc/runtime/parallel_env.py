"""PettingZoo's view of several infants in one world."""

from typing import Any

from pettingzoo import ParallelEnv

from mimoc.runtime.shared_world import SharedWorld


class InfantsParallelEnv(SharedWorld, ParallelEnv[str, Any, Any]):
    """Several infants in one world, as a PettingZoo `ParallelEnv`; see `SharedWorld`."""

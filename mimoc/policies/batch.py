"""The infants that a policy of many acts for: who they are, and what their arrays are."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mimoc.base.classes import described
from mimoc.base.errors import PolicyError
from mimoc.runtime.array_library import NUMPY, torch_library
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import FloatArray
from mimoc.runtime.term import Put


@dataclass(frozen=True)
class Batch:
    """k infants with the same commands and senses, one for each row of observations and actions.

    What is bound to an age has to look again where infants grow: `infants[i].bundle` is another one then.
    """

    infants: Sequence[Infant]
    """The environment of each; on a device, one of the same body that stands for it and is not stepped."""
    arousals: Callable[[], Any]
    """Returns the arousal of each now, shape (k, 1)."""
    xp: Any = field(default_factory=lambda: NUMPY)
    """The array library of observations and actions, by the array API standard."""
    put: Put = np.asarray
    """Moves NumPy's arrays to where observations are; real numbers get 32 bits on a device."""
    is_on_device: bool = False
    """Whether the infants live on a device, also if their arrays are copies for NumPy."""

    def limits(self) -> tuple[FloatArray, FloatArray]:
        """Return the smallest and largest commands of each, shape (k, n), as NumPy's."""
        actuations = [infant.actuation for infant in self.infants]
        return np.stack([item.low for item in actuations]), np.stack([item.high for item in actuations])

    def actions(self, commands: Any) -> Any:
        """Return commands as actions, in numbers of 32 bits."""
        return self.xp.astype(commands, self.xp.float32)

    def real(self, observation: Any) -> Any:
        """Return an observation in the numbers that policies reckon with: of 64 bits, and of 32 on a device."""
        return self.xp.astype(observation, self.xp.float64) if self.xp is NUMPY else observation

    def draw(self, draws: Sequence[Any]) -> Any:
        """Return what each generator gave as one array, shape (k, ...)."""
        return self.put(np.stack(draws))


def batch_of_one(env: Infant) -> Batch:
    """Return a batch of one infant."""
    return Batch((env,), lambda: np.array([[env.arousal]]))


def batch_of(envs: Any) -> Batch:
    """Return the infants of a vector environment; PolicyError if it is none of mimoc's or its arrays are Warp's."""
    if not (hasattr(envs, "infants") and hasattr(envs, "num_envs")):
        raise PolicyError(f"expected a vector environment of mimoc.make_vec, got {described(envs)}")
    if not hasattr(envs, "worlds"):
        return Batch(envs.infants, lambda: np.array([[infant.arousal] for infant in envs.infants]))
    infants = _AssignedInfants(envs)
    if envs.arrays == "numpy":
        return Batch(
            infants, lambda: envs.worlds.arousal.level.cpu().numpy()[:, None].astype(np.float64), is_on_device=True
        )
    if envs.arrays != "torch":
        raise PolicyError(f"policies take no arrays of '{envs.arrays}'; make the environment with arrays=\"torch\"")
    xp, put = torch_library(envs.worlds.arousal.level)
    return Batch(infants, lambda: envs.worlds.arousal.level[:, None], xp, put, is_on_device=True)


class _AssignedInfants(Sequence[Infant]):
    """The infants that stand for those in the worlds of a device now."""

    def __init__(self, envs: Any):
        self._envs = envs

    def __len__(self) -> int:
        return self._envs.num_envs

    def __getitem__(self, row: Any) -> Any:
        if row >= len(self):
            raise IndexError(row)
        return self._envs.assignment.infant(row)

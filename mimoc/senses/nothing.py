"""What an infant without senses observes: Gymnasium wants at least one number."""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.senses.sense import FloatArray, Vector


@dataclass(frozen=True)
class Nothing(Vector):
    """A zero, shape (1,)."""

    layout = ("nothing [0]",)

    def __call__(self, data: mujoco.MjData) -> FloatArray:
        """Return zero."""
        return np.zeros(1)


def nothing() -> Nothing:
    """Return the sense of an infant that has none."""
    return Nothing("nothing", np.zeros(1), np.ones(1), np.zeros(1, np.intp))

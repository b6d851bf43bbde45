"""What an infant without senses observes: Gymnasium wants at least one number."""

import mujoco
import numpy as np

from mimoc.runtime.senses.sense import FloatArray


class Nothing:
    """A zero, shape (1,)."""

    low, high = np.zeros(1), np.ones(1)
    layout = ("nothing [0]",)

    def __call__(self, data: mujoco.MjData) -> FloatArray:
        """Return zero."""
        return np.zeros(1)

"""What an infant without senses observes: Gymnasium wants at least one number."""

import mujoco
import numpy as np

from mimoc.senses.sense import Sample, Vector


class Nothing(Vector):
    """A zero, shape (1,)."""

    def __init__(self):
        super().__init__("nothing", layout=("nothing [0]",), low=0.0, high=1.0)

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return zero."""
        return np.zeros(1)

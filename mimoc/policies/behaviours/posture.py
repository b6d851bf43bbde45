"""A posture that is kept, as in the trials of milestones."""

from collections.abc import Callable

import mujoco
import numpy as np

from mimoc.policies.behaviours.behaviour import Behaviour, Subject
from mimoc.runtime.sense import FloatArray

Lost = Callable[[mujoco.MjData, frozenset[int]], str]
"""Returns why a posture is lost in a state, with the bodies that others may bring to the floor; nothing if it is not.
"""


class Posture(Behaviour):
    """Keeps all joints where they are in a posture."""

    is_whole = True

    def __init__(self, subject: Subject, start: mujoco.MjData, lost: Lost):
        self.joints, self.start, self._lost = np.arange(len(subject.infant.joints)), start, lost
        self._target_rad = start.qpos[subject.infant.angles]

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angles of the posture; see `Behaviour`."""
        return self._target_rad

    def lost(self, data: mujoco.MjData, may_touch: frozenset[int]) -> str:
        """Return why it is lost; see `Behaviour`."""
        return self._lost(data, may_touch)

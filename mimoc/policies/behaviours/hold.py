"""Keeping the pose in which an episode begins."""

import mujoco
import numpy as np

from mimoc.policies.behaviours.behaviour import Behaviour, Subject, read_arguments
from mimoc.policies.control.holding.postures import MOST_TILT_DEG
from mimoc.runtime.sense import FloatArray


class Hold(Behaviour):
    """Keeps all joints where they are when an episode begins; it is lost when the trunk has turned by 45 degrees."""

    is_whole = True

    def __init__(self, subject: Subject):
        self._infant = subject.infant
        self.joints = np.arange(len(self._infant.joints))

    def begin(self, data: mujoco.MjData) -> None:
        """Take note of the pose; see `Behaviour`."""
        self._target_rad = data.qpos[self._infant.angles].copy()
        self._trunk = data.xmat[self._infant.pushed].reshape(3, 3).copy()

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angles at the beginning; see `Behaviour`."""
        return self._target_rad

    def lost(self, data: mujoco.MjData, may_touch: frozenset[int]) -> str:
        """Return whether the trunk has turned; see `Behaviour`."""
        now = data.xmat[self._infant.pushed].reshape(3, 3)
        cosine = (np.trace(self._trunk.T @ now) - 1.0) / 2.0
        return "trunk turned" if cosine < np.cos(np.radians(MOST_TILT_DEG)) else ""


def bind(subject: Subject, text: str = "") -> Hold:
    """Return the behaviour that keeps the pose of the start."""
    read_arguments("hold", text, {})
    return Hold(subject)

"""What is told of everything that is done to an infant, so that it can be written down and done again."""

from collections.abc import Mapping
from typing import Any

import numpy.typing as npt

from mimoc.runtime.sense import Observation


class Observer:
    """Is told of everything that is done to one infant; this one keeps nothing of it.

    Set an infant's `observer` to one that does. Environments that are copied or pickled get a new one of this class.
    """

    keeps = False
    """Whether it wants to be told of control steps, which takes time."""

    def resetting(self) -> None:
        """Be told that the infant is about to be reset."""

    def was_reset(
        self, seed: int | None, options: Mapping[str, Any], observation: Observation, info: Mapping[str, Any]
    ) -> None:
        """Be told that the infant was reset, and what it observes."""

    def stepping(self) -> None:
        """Be told that the infant is about to make a control step."""

    def stepped(
        self, action: npt.NDArray[Any], observation: Observation, judged: tuple[float, bool, bool, Mapping[str, Any]]
    ) -> None:
        """Be told of a control step: the action, and what `step` returns; arrays may be changed afterwards."""

    def grew(self, to: float) -> None:
        """Be told that the infant has grown to an age, in months."""

    def restored(self) -> None:
        """Be told that a state of the infant was restored."""

    def expressed(self, expression: str) -> None:
        """Be told of a new facial expression."""

    def aroused(self, level: float) -> None:
        """Be told of another arousal within an episode."""


NO_OBSERVER = Observer()
"""The observer of an infant that nobody observes."""

"""Senses that are terms: written once, they run on one infant, on many, and on a device."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import mujoco

from mimoc.runtime.term import Term, stack_terms
from mimoc.runtime.worlds import Worlds, worlds_of_one
from mimoc.senses.sense import FloatArray, IntArray, Sample, Vector


class Measure:
    """Measures by a term of one infant; its worlds are views of the data that it was called with last."""

    def __init__(self, term: Term):
        """Give the term its axis of infants."""
        self._term = stack_terms([term])
        self._data: mujoco.MjData | None = None

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return what the term measures now, as a new array without the axis of infants."""
        if data is not self._data:
            self._data, self._worlds = data, worlds_of_one(data)
        return self._term(self._worlds)[0].copy()


class TermSense(Measure, Vector):
    """A sense of n numbers that a term measures: `term(worlds)` returns them, shape (k, n)."""

    def __init__(
        self,
        name: str,
        term: Term,
        layout: Sequence[str],
        low: FloatArray | float,
        high: FloatArray | float,
        bodies: IntArray | None = None,
    ):
        """Describe the numbers; see `Vector`.

        Args:
            name: Of the sense, and of its array in the observation.
            term: Measures them of one infant.
            layout: What each number is, with its unit.
            low: Least value to be observed, of all numbers or of each, shape (n,); finite.
            high: Largest one, likewise.
            bodies: The body in which each is measured, shape (n,).
        """
        Vector.__init__(self, name, layout, low, high, bodies)
        Measure.__init__(self, term)
        self.term = term


@dataclass(frozen=True)
class Zero(Term):
    """A zero, shape (k, 1)."""

    def __call__(self, worlds: Worlds) -> Any:
        """Return zeros."""
        return worlds.xp.zeros_like(worlds.xpos[:, 0, :1])


def nothing() -> TermSense:
    """Return what an infant without senses observes, a zero: Gymnasium wants at least one number."""
    return TermSense("nothing", Zero(), layout=("nothing [0]",), low=0.0, high=1.0)

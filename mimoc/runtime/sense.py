"""What every sense is, and a base for those that are one vector of numbers.

To write a sense of your own, subclass `Vector`: say in `__init__` what each number is and its bounds, look up what you
need in the model once, and return the numbers in `__call__`. That is all:

    class Height(Vector):
        \"\"\"Height of the head above the floor, shape (1,), [m].\"\"\"

        def __init__(self, head: int):
            super().__init__("height", layout=("head [m]",), low=0.0, high=2.0)
            self._head = head

        def __call__(self, data):
            return data.xpos[self._head, 2:].copy()


    def bind(entry, model, bundle):
        return Height(model.body(entry.head).id)

A delay needs nothing in the sense itself: it is called when a sample is due, and what it returned is kept until the
sample arrives.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
from gymnasium.spaces import Box

from mimoc.base.classes import class_name
from mimoc.runtime.filter import Filter
from mimoc.runtime.sound import SoundSources
from mimoc.runtime.term import Term

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
Sample = npt.NDArray[Any]  # What a sense returned at one physics step; its first axis is that of `Sense.bodies`.
Observation = dict[str, npt.NDArray[Any]]


class Sense(ABC):
    """What is measured in a simulation, and how an agent observes it."""

    spaces: Mapping[str, Box]
    """The space of each of its arrays, by name in the observation."""
    bodies: IntArray | None = None
    """The body of the model in which each number of a sample is measured, shape (n,): the legs can have a longer delay.
    None where all are in the head or trunk."""
    term: Term | None = None
    """What measures it, if it is a term: then many infants are read at once, and infants on a device."""
    companion: Any = None
    """The `Companion` that sees each physics step for it and has its state, if it senses what is between samples."""
    filter: Filter | None = None
    """What its organ makes of samples over time, before noise and delay; their first axis is then that of `bodies`."""
    reads_in_threads: bool = False
    """Whether samples of several infants can be taken at the same time, in any threads."""

    @property
    def class_name(self) -> str:
        """Class of what measures, as `module:Class`."""
        return class_name(self if self.term is None else self.term)

    @property
    @abstractmethod
    def layout(self) -> tuple[str, ...]:
        """What each number is, with its unit, in the order of the observation."""

    @abstractmethod
    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return the sample at this physics step, as a new array; never write to *data*."""

    @abstractmethod
    def observe(self, sample: Sample) -> Observation:
        """Return what an agent sees of a sample that has arrived, as new arrays within `spaces`."""

    def write(self, sample: Sample, observation: Observation) -> None:
        """Write what `observe` returns into arrays that there are already."""
        for name, array in self.observe(sample).items():
            observation[name][...] = array

    def rebind(self, entry: Any, model: mujoco.MjModel) -> bool:
        """Read the same infant at another age or in another scene from now on, or return False: it is bound anew then.

        Args:
            entry: What the manifest says of this sense there.
            model: The infant's model there.
        """
        return False

    def listen_to(self, sources: SoundSources, voice: Any = None, others: Sequence[Any] = ()) -> None:
        """Hear these sources besides what sounds by itself, and the infant's own `Voice` and those of others.

        Most senses hear nothing.
        """
        return

    def close(self) -> None:
        """Free what the sense holds, such as an OpenGL context; nothing is read from it afterwards."""
        return


class Vector(Sense):
    """A sense that is one vector of n numbers; a subclass defines `__call__`, which returns them."""

    def __init__(
        self,
        name: str,
        layout: Sequence[str],
        low: FloatArray | float,
        high: FloatArray | float,
        bodies: IntArray | None = None,
    ):
        """Describe the numbers.

        Args:
            name: Of the sense, and of its array in the observation.
            layout: What each number is, with its unit, such as `head [m]`.
            low: Least value to be observed, of all numbers or of each, shape (n,); finite.
            high: Largest one, likewise.
            bodies: The body in which each is measured, shape (n,); see `Sense.bodies`.
        """
        self.name, self.bodies, self._layout = name, bodies, tuple(layout)
        self.low, self.high = (np.broadcast_to(bound, len(self._layout)).astype(np.float64) for bound in (low, high))
        self.spaces = {name: Box(self.low.astype(np.float32), self.high.astype(np.float32), dtype=np.float32)}

    @property
    def layout(self) -> tuple[str, ...]:
        """What each number is."""
        return self._layout

    def observe(self, sample: Sample) -> Observation:
        """Return the sample within its bounds; two calls here cost less than `np.clip`."""
        observed = np.maximum(sample, self.low)
        np.minimum(observed, self.high, out=observed)
        return {self.name: observed.astype(np.float32)}


@dataclass(frozen=True, slots=True)
class SkinState:
    """Where the n points of a skin are, and the forces on them."""

    bodies: npt.NDArray[np.str_]  # The name of each point's body, shape (n,).
    positions: FloatArray  # Shape (n, 3), in the world, [m].
    forces: FloatArray  # Shape (n, 3), in the world, [N].

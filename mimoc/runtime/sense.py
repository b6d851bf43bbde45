"""Senses: what each of them is, a base for those that are one vector of numbers, and how they are bound to a model.

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
from types import MappingProxyType
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt
from gymnasium.spaces import Box

from mimoc.base.classes import class_name
from mimoc.base.errors import KindError
from mimoc.base.kinds import check_custom_object, function_of
from mimoc.base.units import to_steps
from mimoc.bundle.io import Bundle
from mimoc.runtime.contract import check_numbers, check_observation, check_rows
from mimoc.runtime.filter import Filter
from mimoc.runtime.sound import SoundSources
from mimoc.runtime.term import Term, stack_terms
from mimoc.runtime.worlds import Worlds, worlds_of_one
from mimoc.schema.kinds import SENSES
from mimoc.schema.senses import DelayEntry

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
Sample = npt.NDArray[Any]  # What a sense returned at one physics step; its first axis is that of `Sense.bodies`.
Observation = dict[str, npt.NDArray[Any]]
NOTHING: Mapping[str, Any] = MappingProxyType({})


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
        self.name = name
        self.bodies = bodies
        self._layout = tuple(layout)
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


class Measure:
    """Reads a term of one infant."""

    def __init__(self, term: Term):
        self._term = stack_terms([term])
        self._data: mujoco.MjData | None = None

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return the present value of the term as a new array without the axis of infants."""
        if data is not self._data:
            self._data, self._worlds = data, worlds_of_one(data)
            check_rows(f"the term {class_name(self._term)}", self._term(self._worlds), 1)
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
        """Describe the numbers as for a `Vector`; *term* measures them of one infant."""
        Vector.__init__(self, name, layout, low, high, bodies)
        Measure.__init__(self, term)
        self.term = term


@dataclass(frozen=True)
class Zero(Term):
    """A zero, shape (k, 1): what an infant without senses observes, as Gymnasium wants at least one number."""

    def __call__(self, worlds: Worlds) -> Any:
        """Return zeros."""
        return worlds.xp.zeros_like(worlds.xpos[:, 0, :1])


class CustomSense(Sense):
    """A sense made of an object of a user's own.

    The object has `space`, a Gymnasium `Box`, and is called with the simulation's `MjData` for a sample: an array of
    that shape. It can also have `bind(model, bundle)`, called whenever a model was loaded and before `space` is read;
    `delay_ms`, a whole number of physics steps (0 without it); and `close()`.

    In place of being called, it can have a `term` once it is bound, a `Term` that measures the sample with a leading
    axis of infants: then many infants are read at once, and infants on a device.
    """

    def __init__(self, name: str, custom: Any, model: mujoco.MjModel, bundle: Bundle):
        is_object = not isinstance(custom, type)
        if is_object and hasattr(custom, "bind"):
            custom.bind(model, bundle)
        self.term = getattr(custom, "term", None) if is_object else None
        if self.term is None:
            check_custom_object(f"sense '{name}'", custom, "__call__", "an object that is called with MuJoCo's data")
        self._read = custom if self.term is None else Measure(self.term)
        if not isinstance(getattr(custom, "space", None), Box):
            raise KindError(f"sense '{name}' has no attribute 'space', the gymnasium.spaces.Box of what it returns")
        self._name, self._custom, self._space = name, custom, custom.space
        self.spaces, self._is_checked = {name: self._space}, False
        delay_ms = float(getattr(custom, "delay_ms", 0.0))
        try:
            to_steps(delay_ms, bundle.manifest.timestep_ms)
        except ValueError as error:
            raise KindError(f"sense '{name}': {error}") from None
        self.delay = DelayEntry(ms=delay_ms)

    @property
    def class_name(self) -> str:
        """Class of the object, as `module:Class`."""
        return class_name(self._custom)

    @property
    def layout(self) -> tuple[str, ...]:
        """The index of each number, as only the object knows what it is."""
        return tuple(f"{self._name} {index}" for index in range(int(np.prod(self._space.shape))))

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return the present sample as an array of its own."""
        sample = self._read(data)
        if not self._is_checked:
            what = f"sense '{self._name}' ({self.class_name}): its sample"
            check_numbers(what, sample, self._space.shape, self._space.dtype)
            self._is_checked = True
        return np.array(sample, dtype=np.float64)

    def observe(self, sample: Sample) -> Observation:
        """Return a sample within its space, in the type of its space."""
        clipped = np.clip(sample, self._space.low, self._space.high).reshape(self._space.shape)
        return {self._name: clipped.astype(self._space.dtype)}

    def close(self) -> None:
        """Close the object, if it can be."""
        if hasattr(self._custom, "close"):
            self._custom.close()


def by_name(objects: Any, what: str = "senses", names: str = "the name of their observation") -> dict[str, Any]:
    """Return the objects that a script passes, or raise a KindError if they are no dictionary."""
    if not isinstance(objects, Mapping):
        raise KindError(f"{what} is {objects!r:.60}; pass a dictionary of objects by {names}")
    return dict(objects)


def bind_senses(
    bundle: Bundle, model: mujoco.MjModel, former: Mapping[str, Sense] = NOTHING, custom: Mapping[str, Any] = NOTHING
) -> dict[str, Sense]:
    """Return the senses of an infant by name; one that has none observes `nothing`."""
    entries = dict(bundle.manifest.senses)
    kept = {name: sense for name, sense in former.items() if sense.rebind(entries.get(name), model)}
    for name in former.keys() - kept.keys():
        former[name].close()
    names = [name for name, entry in entries.items() if entry is not None]
    if taken := sorted(custom.keys() & set(names)):
        raise KindError(f"this infant has a sense '{taken[0]}' already; pass yours under another name")
    senses: dict[str, Sense] = {name: kept.get(name) or bind_sense(name, bundle, model) for name in names}
    senses |= {name: CustomSense(name, sense, model, bundle) for name, sense in custom.items()}
    owners: dict[str, str] = {}
    for name, sense in senses.items():
        for key in sense.spaces:
            if owners.setdefault(key, name) != name:
                raise KindError(f"the senses '{owners[key]}' and '{name}' both observe '{key}'; rename one of the two")
    return senses or {"nothing": TermSense("nothing", Zero(), ("nothing [0]",), low=0.0, high=1.0)}


def bind_sense(name: str, bundle: Bundle, model: mujoco.MjModel) -> Any:
    """Return one of the senses that an infant has; see `bind_senses`."""
    return function_of(SENSES[name].run, "bind")(getattr(bundle.manifest.senses, name), model, bundle)


def check_sense(name: str, sense: Sense, sample: Any) -> None:
    """Check the first sample of a sense, after its filter and noise, and what is observed of it."""
    what = f"sense '{name}' ({sense.class_name})"
    if isinstance(sense, Vector):
        check_numbers(f"{what}: its sample", sample, (len(sense.layout),), np.float64)
    check_observation(what, sense.observe(sample), sense.spaces)

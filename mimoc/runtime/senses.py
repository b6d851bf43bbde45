"""Binding senses to a model, those of a bundle and a script's own: names are looked up once, then arrays are read."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import mujoco
import numpy as np
from gymnasium.spaces import Box

from mimoc.base.classes import class_name
from mimoc.base.errors import KindError
from mimoc.base.kinds import check_custom_object, function_of
from mimoc.base.units import to_steps
from mimoc.bundle.io import Bundle
from mimoc.runtime.contract import check_numbers, check_rows
from mimoc.runtime.sense import FloatArray, IntArray, Observation, Sample, Sense, Vector
from mimoc.runtime.term import Term, stack_terms
from mimoc.runtime.worlds import Worlds, worlds_of_one
from mimoc.schema.kinds import SENSES
from mimoc.schema.senses import DelayEntry


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
        """Bind the object to a model; *name* is that of its observation."""
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
        """The number of each number: what it is, only the object knows."""
        return tuple(f"{self._name} {index}" for index in range(int(np.prod(self._space.shape))))

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return the sample now, as an array of its own."""
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
    """Return the objects that a script passes, to sense with unless *what* says otherwise, by name."""
    if not isinstance(objects, Mapping):
        raise KindError(f"{what} is {objects!r:.60}; pass a dictionary of objects by {names}")
    return dict(objects)


NONE: Mapping[str, Any] = MappingProxyType({})


def bind_senses(
    bundle: Bundle, model: mujoco.MjModel, former: Mapping[str, Sense] = NONE, custom: Mapping[str, Any] = NONE
) -> dict[str, Sense]:
    """Return the senses of an infant by name; one that has none observes nothing."""
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

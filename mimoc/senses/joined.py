"""The senses of many infants at once: one array expression where they can be, or one infant after another."""

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

import mujoco
import numpy as np

from mimoc.kinds import function_of
from mimoc.senses import SENSES
from mimoc.senses.sense import FloatArray, Observation, Sample, Sense, Vector


class Simulations(Protocol):
    """The simulations of n infants."""

    @property
    def datas(self) -> Sequence[mujoco.MjData]:
        """The state of each."""
        ...

    def each(self, function: Callable[[int], Sample], infants: Sequence[int]) -> Sequence[Sample]:
        """Return what a function returns for k of them, called in any threads."""
        ...

    def array(self, field: str, infants: Sequence[int]) -> FloatArray:
        """Return a field of `MjData` of k of them, shape (k, size)."""
        ...


class Joined(Protocol):
    """A sense of n infants."""

    def read(self, simulations: Simulations, infants: Sequence[int]) -> Sequence[Sample]:
        """Return the samples of k infants now: new arrays, or rows of one."""
        ...

    def observe(self, samples: Sequence[Sample]) -> Observation:
        """Return what agents see of a sample of each infant, as new arrays with a leading axis of n."""
        ...


class OneByOne:
    """Senses that are read one infant after another, as alone."""

    def __init__(self, senses: Sequence[Sense]):
        """Join the sense of each infant."""
        self._senses = senses

    def read(self, simulations: Simulations, infants: Sequence[int]) -> Sequence[Sample]:
        """Return a sample of each."""
        return [self._senses[infant](simulations.datas[infant]) for infant in infants]

    def observe(self, samples: Sequence[Sample]) -> Observation:
        """Return what each agent sees."""
        seen = [sense.observe(sample) for sense, sample in zip(self._senses, samples, strict=True)]
        return {name: np.stack([each[name] for each in seen]) for name in seen[0]}


class Fields:
    """What a sense reads of k infants: `fields.qpos` is that of all of them, shape (k, nq)."""

    def __init__(self, simulations: Simulations, infants: Sequence[int]):
        """Read fields of some infants when they are asked for."""
        self._simulations, self._infants = simulations, infants

    def __getattr__(self, field: str) -> FloatArray:
        """Return a field of `MjData`, which is read once."""
        found = self._simulations.array(field, self._infants)
        setattr(self, field, found)
        return found


class JoinedVector:
    """Vectors whose numbers one expression computes for all infants: `Vector.measure`, along the last axis."""

    def __init__(self, senses: Sequence[Vector]):
        """Join senses that read the same places of their models; what differs is in their `constants`."""
        self._first = senses[0]
        self._low, self._high = (np.stack([getattr(each, bound) for each in senses]) for bound in ("low", "high"))
        self._constants = [np.stack(each) for each in zip(*(sense.constants for sense in senses), strict=True)]

    def read(self, simulations: Simulations, infants: Sequence[int]) -> Sequence[Sample]:
        """Return a row for each."""
        chosen = np.asarray(infants)
        constants = [each[chosen] for each in self._constants]
        return list(self._first.measure(Fields(simulations, infants), *constants))

    def observe(self, samples: Sequence[Sample]) -> Observation:
        """Return the samples within the bounds of each infant."""
        observed = np.concatenate(samples).reshape(self._low.shape)
        np.maximum(observed, self._low, out=observed)
        np.minimum(observed, self._high, out=observed)
        return {self._first.name: observed.astype(np.float32)}


def join(name: str, senses: Sequence[Sense]) -> Joined:
    """Return the sense of many infants, which has the same name for all."""
    first, many = senses[0], SENSES[name].many if name in SENSES else None
    if many is not None:
        return function_of(many, "join")(senses) or OneByOne(senses)
    if isinstance(first, Vector) and first.expression is not None:
        same = all(
            type(each) is type(first) and getattr(each, "expression", None) == first.expression for each in senses
        )
        return JoinedVector(senses) if same else OneByOne(senses)  # pyright: ignore[reportArgumentType] - They are.
    return OneByOne(senses)


def join_all(senses: Sequence[Mapping[str, Sense]]) -> dict[str, Joined]:
    """Return the senses of many infants by name."""
    return {name: join(name, [each[name] for each in senses]) for name in senses[0]}

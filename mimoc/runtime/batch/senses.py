"""The senses of many infants: read and observed as arrays of all of them where that can be, or one after another."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import mujoco
import numpy as np

from mimoc.base.classes import class_name
from mimoc.base.kinds import function_of
from mimoc.runtime.batch.physics import ThreadedPhysics
from mimoc.runtime.term import differing_field, stack_terms, take_rows
from mimoc.runtime.worlds import Worlds
from mimoc.senses import SENSES
from mimoc.senses.contract import check_rows
from mimoc.senses.sense import Observation, Sample, Sense, Vector

Read = Callable[[Worlds], Sequence[Sample]]
"""Returns the samples of the k infants that it is for, from their worlds: new arrays, or rows of one."""
SIZES = (
    *("nq", "nv", "na", "nu", "nbody", "njnt", "ngeom", "nsite", "ncam", "nlight", "ntendon", "nmocap", "neq"),
    *("nsensordata", "nuserdata"),
)
"""On which the shapes of the fields of `MjData` depend."""


class BatchSense:
    """A sense of n infants, which has the same name for all."""

    def __init__(self, name: str, senses: Sequence[Sense], models: Sequence[mujoco.MjModel], physics: ThreadedPhysics):
        """Find out which infants can be read together: those with terms of equal addresses in models of equal size."""
        self._name, self._senses, self._physics = name, senses, physics
        self.kinds = _kinds(senses, models)
        """A number for each infant; infants with the same number can be read together."""
        self._stacked: dict[int, tuple[list[int], Any]] = {}
        """The infants of each kind that has terms, in order, and the term of all of them."""
        for kind in set(self.kinds):
            members = [infant for infant, other in enumerate(self.kinds) if other == kind]
            terms: list[Any] = [senses[infant].term for infant in members]
            if terms[0] is not None:
                self._stacked[kind] = members, stack_terms(terms)
        self._bounds = None
        if all(isinstance(sense, Vector) and type(sense).observe is Vector.observe for sense in senses):
            vectors: Sequence[Any] = senses
            self._bounds = [np.stack([getattr(sense, bound) for sense in vectors]) for bound in ("low", "high")]

    def reader(self, infants: Sequence[int]) -> Read:
        """Return what reads some infants of one kind."""
        senses: list[Any] = [self._senses[infant] for infant in infants]
        if senses[0].term is not None:
            members, stacked = self._stacked[self.kinds[infants[0]]]
            term = take_rows(stacked, np.searchsorted(members, infants))
            return partial(_rows, self._name, term, len(infants))
        together = SENSES[self._name].many if self._name in SENSES else None
        if together and (read := function_of(together, "join")(senses)):
            return read
        if all(sense.reads_in_threads for sense in senses):
            in_threads, numbers = self._physics.in_threads, range(len(senses))
            return lambda worlds: in_threads(lambda number: senses[number](worlds.datas[number]), numbers)
        return lambda worlds: [sense(data) for sense, data in zip(senses, worlds.datas, strict=True)]

    def observe(self, samples: Sequence[Sample]) -> Observation:
        """Return what each of the n agents sees of a sample, as new arrays with a leading axis of n."""
        if self._bounds:
            low, high = self._bounds
            observed = np.concatenate(samples).reshape(low.shape)
            np.maximum(observed, low, out=observed)
            np.minimum(observed, high, out=observed)
            return {self._name: observed.astype(np.float32)}
        spaces, count = self._senses[0].spaces, len(samples)
        observation = {name: np.empty((count, *space.shape), space.dtype) for name, space in spaces.items()}
        for index, (sense, sample) in enumerate(zip(self._senses, samples, strict=True)):
            sense.write(sample, {name: array[index] for name, array in observation.items()})
        return observation


def _rows(name: str, term: Any, infants: int, worlds: Worlds) -> list[Sample]:
    """Return what the stacked term of a sense measures of each of some infants."""
    samples = list(term(worlds))
    if len(samples) != infants:
        check_rows(f"sense '{name}': the term {class_name(term)}", np.array(samples), infants)
    return samples


def _kinds(senses: Sequence[Sense], models: Sequence[mujoco.MjModel]) -> list[int]:
    """Return a number for each infant, which is the same for those that can be read together."""
    firsts: list[tuple[Sense, tuple[int, ...]]] = []
    kinds: list[int] = []
    for sense, model in zip(senses, models, strict=True):
        sizes = tuple(getattr(model, name) for name in SIZES)
        alike = (number for number, first in enumerate(firsts) if first[1] == sizes and _is_alike(first[0], sense))
        kinds.append(next(alike, len(firsts)))
        if kinds[-1] == len(firsts):
            firsts.append((sense, sizes))
    return kinds


def _is_alike(first: Sense, other: Sense) -> bool:
    if first.term is None or other.term is None:
        return first.term is other.term
    return differing_field([first.term, other.term]) is None

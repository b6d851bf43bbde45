"""Measuring: values of registered quantities, gathered while an infant acts, and reduced to one of a run."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.base.errors import KindError
from mimoc.base.kinds import function_of
from mimoc.base.quantities import measured_in
from mimoc.base.quantities.quantity import Quantity
from mimoc.runtime.infant import Infant
from mimoc.runtime.term import stack_terms
from mimoc.runtime.worlds import worlds_of_one

Value = bool | int | float | None

REDUCERS: Mapping[str, Callable[[Sequence[Any]], Value]] = {
    "mean": lambda values: float(np.mean(values)) if values else None,
    "min": lambda values: float(min(values)) if values else None,
    "max": lambda values: float(max(values)) if values else None,
    "path": lambda points: float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()),
    "all": lambda values: all(map(bool, values)),
    "any": lambda values: any(map(bool, values)),
    "count": len,
}
"""From the values that there are to one of a run; those that say how much of nothing are None."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of an episode; fields of quantities over episodes are its attributes."""

    total_reward: float
    steps: int  # Control steps.
    success: bool
    time_to_success_s: float | None  # Simulated time; None if it was not successful.


def measure(over: str, step: str, things: Sequence[object]) -> dict[str, Value]:
    """Return the quantities that a step of a cohort measures over children, poses or episodes, by name.

    Each of the *things* has a value as an attribute; a KindError says which has none.
    """
    measured = [quantity for quantity in measured_in(step) if quantity.over == over]
    return {quantity.name: reduced(quantity, [_field(quantity, item) for item in things]) for quantity in measured}


class StepMeasures:
    """Values of the quantities over control steps of one infant, which may grow meanwhile."""

    def __init__(self, env: Infant, step: str):
        """Bind the quantities of a step; raise a KindError if one does not measure a number."""
        self._env, self._data = env, env.data
        self._quantities = [
            quantity
            for quantity in measured_in(step)
            if quantity.over == "step" and not (step == "record" and quantity.reduce == "path")
        ]
        self._readers = self._bind()
        self._values: dict[str, list[Any]] = {quantity.name: [] for quantity in self._quantities}

    def read(self, info: Mapping[str, Any]) -> dict[str, Any]:
        """Return the values of this moment by name, given the `info` of the control step."""
        if self._env.data is not self._data:
            self._data, self._readers = self._env.data, self._bind()
        readers = self._readers
        return {
            item.name: readers[item.name]() if item.name in readers else info.get(item.key) for item in self._quantities
        }

    def add(self, info: Mapping[str, Any]) -> None:
        """Keep the values of this moment."""
        for name, value in self.read(info).items():
            self._values[name].append(value)

    def measures(self) -> dict[str, Value]:
        """Return what was kept, reduced to one value each, by name."""
        return {quantity.name: reduced(quantity, self._values[quantity.name]) for quantity in self._quantities}

    def _bind(self) -> dict[str, Callable[[], Any]]:
        env, worlds = self._env, worlds_of_one(self._env.data)
        readers: dict[str, Callable[[], Any]] = {}
        for quantity in self._quantities:
            if quantity.term is not None:
                term = stack_terms([function_of(quantity.term, quantity.name)(env.model, env.manifest)])
                readers[quantity.name] = lambda term=term: term(worlds)[0].copy()
            elif quantity.read is not None:
                readers[quantity.name] = function_of(quantity.read, quantity.name)(env)
            shape = np.shape(readers[quantity.name]()) if quantity.name in readers else ()
            if shape and quantity.reduce != "path":
                what = f"'{quantity.name}' measures an array of shape {shape} of an infant"
                raise KindError(f"{what}; return a number, or reduce points by 'path'")
        return readers


def _field(quantity: Quantity, item: object) -> Any:
    try:
        return getattr(item, quantity.key)
    except AttributeError:
        has = f"{type(item).__name__}, which has no '{quantity.key}'"
        raise KindError(f"the quantity '{quantity.name}' is over {quantity.over}: {has}; name a field of it") from None


def reduced(quantity: Quantity, values: Sequence[Any]) -> Value:
    """Return what a quantity makes of the values that there are, without None."""
    return REDUCERS[quantity.reduce]([value for value in values if value is not None])

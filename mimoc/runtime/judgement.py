"""What a task says of a control step, and what that must be."""

import math
from collections.abc import Callable, Collection, Mapping
from numbers import Real
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol

import numpy as np

from mimoc.base.classes import class_name
from mimoc.base.errors import KindError
from mimoc.runtime.contract import told

NOTHING: Mapping[str, Any] = MappingProxyType({})

FORCES = "xfrc_applied"
"""The field of the state with a force and a torque on each body, which is 0 after a reset, among a term's changes."""


class Change(NamedTuple):
    """New values of a field of the model, which the task's `model_fields` must declare, or forces on `forced`."""

    where: Any
    """For which of k infants the field changes, shape (k,)."""
    values: Callable[[], Any]
    """Returns the new values of the n declared rows, shape (k, n), or (k, n, ...) for whole rows."""
    column: int | None = None
    """The number of each row that changes; None for whole rows."""


class Judgement(NamedTuple):
    """What a task says of a control step: numbers of one infant, or arrays of k infants, shape (k,), from a term.

    Example:
        >>> import mimoc
        >>> judgement = mimoc.Judgement({"height": 0.3, "effort": -0.1}, success=False)
        >>> round(judgement.reward, 3)
        0.2
    """

    reward_terms: Mapping[str, Any]
    """Terms of the reward, by name; `info` has them as `reward_terms`."""
    success: Any = False
    """Whether the goal is reached; `info` has it as `is_success`."""
    terminated: Any = False
    """Whether the episode ends with this step."""
    memory: Mapping[str, Any] = NOTHING
    """What the task remembers from now on, shape (k, ...), without what stays as it is; only from a term."""
    changes: Mapping[str, Change] = NOTHING
    """What changes in the model, by name of the field; only from a term."""

    @property
    def reward(self) -> Any:
        """Sum of the terms."""
        return sum(self.reward_terms.values(), 0.0)

    def of_one(self) -> "Judgement":
        """Return a term's judgement of one infant in numbers."""
        terms = {name: values.item() for name, values in self.reward_terms.items()}
        return Judgement(terms, bool(self.success), bool(self.terminated))


Verdict = Judgement  # The name that tasks of scripts know it by.
NO_REWARD = Judgement({})
EXPECTED = "expected a finite number, or a mimoc.Judgement of such by name"


class Judging(Protocol):
    """What a task says of itself in an error."""

    @property
    def class_name(self) -> str:
        """Its class, as `module:Class`."""
        ...


def reward_of(judgement: Judgement, task: Judging) -> float:
    """Return the reward of one infant as a number, after every control step."""
    try:
        reward = float(judgement.reward)
        if math.isfinite(reward):
            return reward
    except (TypeError, ValueError, AttributeError):  # Text, arrays of several numbers, or no mapping at all.
        pass
    check_judgement(judgement, task)
    raise KindError(f"{_named(task)}: the terms of its reward add up to {told(judgement.reward)}; {EXPECTED}")


def check_judgement(judgement: Judgement, task: Judging) -> None:
    """Check what a task says of one infant."""
    if not isinstance(judgement, Judgement) or not isinstance(judgement.reward_terms, Mapping):
        raise KindError(f"{_named(task)}: its judgement is {told(judgement)}; {EXPECTED}")
    for name, value in judgement.reward_terms.items():
        if not _is_number(value) or not math.isfinite(value):
            raise KindError(f"{_named(task)}: the term '{name}' of its reward is {told(value)}; {EXPECTED}")
    for name in ("success", "terminated"):
        if not _is_number(value := getattr(judgement, name)) or value not in (0, 1):
            raise KindError(f"{_named(task)}: '{name}' of its judgement is {told(value)}; expected True or False")


def check_term_judgement(
    judgement: Any, term: object, infants: int, memory: Mapping[str, Any], changeable: Collection[str]
) -> None:
    """Check what a term says of some infants, by its shapes alone, so that nothing waits for a device."""
    what = f"the term {class_name(term)}"
    if not isinstance(judgement, Judgement) or not isinstance(judgement.reward_terms, Mapping):
        raise KindError(f"{what}: its judgement is {told(judgement)}; expected a mimoc.Judgement")
    rows = {f"the term '{name}' of its reward": value for name, value in judgement.reward_terms.items()}
    rows |= {f"'{name}' of its changes: where": change.where for name, change in judgement.changes.items()}
    for name in ("success", "terminated"):
        if not isinstance(value := getattr(judgement, name), bool):
            rows[f"'{name}' of its judgement"] = value
    for of, values in rows.items():
        if _shape(values) != (infants,):
            raise KindError(f"{what}: {of} is {told(values)}; expected an array of shape ({infants},), one an infant")
    for name, values in judgement.memory.items():
        if name not in memory:
            known = ", ".join(memory) or "nothing"
            raise KindError(f"{what}: '{name}' of its memory is not what its task remembers: {known}")
        if _shape(values) != _shape(memory[name]):
            expected = f"expected an array of shape {_shape(memory[name])}, as before"
            raise KindError(f"{what}: '{name}' of its memory is {told(values)}; {expected}")
    for name in judgement.changes:
        if name not in changeable:
            raise KindError(f"{what}: changes '{name}', which the model_fields of its task do not declare")


def _named(task: Judging) -> str:
    return f"task {task.class_name}"


def _shape(value: Any) -> tuple[int, ...] | None:
    """Return the shape of an array of any library; None if it is none."""
    return tuple(value.shape) if hasattr(value, "shape") else None


def _is_number(value: Any) -> bool:
    """Return whether something is a real number, or an array of one without axes."""
    if isinstance(value, (Real, np.bool_)):
        return True
    try:
        return _shape(value) == () and math.isfinite(value)
    except (TypeError, ValueError):
        return False

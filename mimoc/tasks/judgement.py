"""What a task says of a control step."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

NOTHING: Mapping[str, Any] = MappingProxyType({})


class Change(NamedTuple):
    """New values of a field of the model, which the task's `model_fields` must declare."""

    where: Any
    """For which of k infants the field changes, shape (k,)."""
    values: Callable[[], Any]
    """Returns the new values of the n declared rows, shape (k, n), or (k, n, ...) for whole rows."""
    column: int | None = None
    """The number of each row that changes; None for whole rows."""


class Judgement(NamedTuple):
    """What a task says of a control step: numbers of one infant, or arrays of k infants, shape (k,), from a term."""

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


NO_REWARD = Judgement({})

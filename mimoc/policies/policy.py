"""What a policy is."""

import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import Observation

Policy = Callable[[np.random.Generator, Observation], np.ndarray]
"""Returns the action for an observation, shape (n,); all random numbers come from the generator.

It can have a method `metrics()`, which returns numbers for the summary of a run, by name with the unit: `hand_error_m`;
`steps_per_episode`, the control steps after which its episodes end, as in its training; `reset()`, which is called
whenever an episode begins, for a policy that remembers what it sensed; and `begin()`, for one that puts the infant
where its episodes begin, which returns what it observes there. Where nobody calls that, its first action does it.
"""
BatchPolicy = Callable[[Sequence[np.random.Generator], Any], Any]
"""Returns the actions of k infants, shape (k, n), for a generator of each and their observations; row i is what
`Policy` returns for infant i. Of infants on a device, the arrays are of the library of their observations.

It can have a method `reset(rows)`, a boolean array of shape (k,): the episodes of these infants begin anew.
"""
PolicyMaker = Callable[[Infant], Policy]


def metrics_of(policy: Policy) -> Mapping[str, float]:
    """Return the numbers that a policy tells of a run; none for a policy that has no `metrics`."""
    metrics = getattr(policy, "metrics", None)
    return metrics() if metrics else {}


def start_again(policy: Policy) -> None:
    """Let a policy begin an episode; one without `reset` remembers nothing of the last."""
    reset = getattr(policy, "reset", None)
    if reset:
        reset()


def begin(policy: Policy) -> Observation | None:
    """Let a policy put the infant where its episode begins; None if it leaves it where it is."""
    put = getattr(policy, "begin", None)
    return put() if put else None


def begin_rows(policy: BatchPolicy, rows: Any) -> None:
    """Let a policy of many begin the episodes of some rows; see `start_again`."""
    reset = getattr(policy, "reset", None)
    if reset:
        reset(rows)


def episode_limit_of(policy: Policy) -> float:
    """Return the control steps after which a policy's episodes end: infinity for one that does not say so."""
    return getattr(policy, "steps_per_episode", None) or math.inf


def numbered(labels: Sequence[str]) -> tuple[str, ...]:
    """Return labels that differ: the second `random` is `random_2`."""
    seen = Counter[str]()
    result = []
    for label in labels:
        seen[label] += 1
        result.append(label if seen[label] == 1 else f"{label}_{seen[label]}")
    return tuple(result)


def merged_metrics(metrics: Sequence[Mapping[str, float]], labels: Sequence[str]) -> dict[str, float]:
    """Return metrics of several policies; a name that several have stands behind the label of each: `reach_error_m`."""
    count = Counter(name for item in metrics for name in item)
    return {
        name if count[name] == 1 else f"{label}_{name}": value
        for label, item in zip(labels, metrics, strict=True)
        for name, value in item.items()
    }

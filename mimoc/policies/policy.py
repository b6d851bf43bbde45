"""Policies: their protocol for one infant and for many, the batches that the latter act for, and the two simplest."""

import copy
import math
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mimoc.base.classes import described
from mimoc.base.errors import PolicyError
from mimoc.bundle.model import physics_of, set_physics
from mimoc.bundle.world import overlaps
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import FloatArray, Observation
from mimoc.runtime.term import Put
from mimoc.runtime.worlds import NUMPY, torch_library

Policy = Callable[[np.random.Generator, Observation], np.ndarray]
"""Returns the action for an observation, shape (n,); all random numbers come from the generator.

It can have a method `metrics()`, which returns numbers for the summary of a run, by name with the unit: `hand_error_m`;
`notes()`, which returns sentences for it, such as what the policy knows that no sense tells;
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


def metrics_of(policy: Policy | BatchPolicy) -> Mapping[str, float]:
    """Return the numbers that a policy tells of a run; none for a policy that has no `metrics`."""
    metrics = getattr(policy, "metrics", None)
    return metrics() if metrics else {}


def notes_of(policy: Policy | BatchPolicy) -> tuple[str, ...]:
    """Return the sentences that a policy tells of a run; none for a policy that has no `notes`."""
    notes = getattr(policy, "notes", None)
    return tuple(notes()) if notes else ()


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


class OfOne:
    """The policy of a single infant that a policy of many is: a batch of its own."""

    def __init__(self, many: BatchPolicy):
        self.many = many

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the action, shape (n,)."""
        return self.many([generator], {name: reading[None] for name, reading in observation.items()})[0]

    def reset(self) -> None:
        """Begin an episode."""
        begin_rows(self.many, np.array([True]))

    def metrics(self) -> Mapping[str, float]:
        """Return what the policy tells of a run."""
        return metrics_of(self.many)

    def notes(self) -> tuple[str, ...]:
        """Return what the policy tells of a run in sentences."""
        return notes_of(self.many)


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


@dataclass(frozen=True)
class Batch:
    """k infants with the same commands and senses, one for each row of observations and actions.

    What is bound to an age has to look again where infants grow: `infants[i].bundle` is another one then.
    """

    infants: Sequence[Infant]
    """The environment of each; on a device, one of the same body that stands for it and is not stepped."""
    arousals: Callable[[], Any]  # Returns the arousal of each now, shape (k, 1).
    xp: Any = field(default_factory=lambda: NUMPY)
    """The array library of observations and actions, by the array API standard."""
    put: Put = np.asarray  # Moves NumPy's arrays to where observations are; real numbers get 32 bits on a device.
    is_on_device: bool = False  # Whether the infants live on a device, also if their arrays are copies for NumPy.
    read: Callable[[str], Any] | None = None
    """Returns a field of MuJoCo's state of all infants on a device, such as `qpos`, shape (k, nq)."""

    def limits(self) -> tuple[FloatArray, FloatArray]:
        """Return the smallest and largest commands of each, shape (k, n), as NumPy's."""
        actuations = [infant.actuation for infant in self.infants]
        return np.stack([item.low for item in actuations]), np.stack([item.high for item in actuations])

    def actions(self, commands: Any) -> Any:
        """Return commands as actions, in numbers of 32 bits."""
        return self.xp.astype(commands, self.xp.float32)

    def real(self, observation: Any) -> Any:
        """Return an observation in the numbers that policies reckon with: of 64 bits, and of 32 on a device."""
        return self.xp.astype(observation, self.xp.float64) if self.xp is NUMPY else observation

    def draw(self, draws: Sequence[Any]) -> Any:
        """Return what each generator gave as one array, shape (k, ...)."""
        return self.put(np.stack(draws))


def batch_of_one(env: Infant) -> Batch:
    """Return a batch of one infant."""
    return Batch((env,), lambda: np.array([[env.arousal]]))


def batch_of(envs: Any) -> Batch:
    """Return the infants of a vector environment; PolicyError if it is none of mimoc's or its arrays are Warp's."""
    if not (hasattr(envs, "infants") and hasattr(envs, "num_envs")):
        raise PolicyError(f"expected a vector environment of mimoc.make_vec, got {described(envs)}")
    if not hasattr(envs, "worlds"):
        return Batch(envs.infants, lambda: np.array([[infant.arousal] for infant in envs.infants]))
    infants = _AssignedInfants(envs)
    state = envs.worlds.state
    if envs.arrays == "numpy":
        return Batch(
            infants,
            lambda: envs.worlds.arousal.level.cpu().numpy()[:, None].astype(np.float64),
            is_on_device=True,
            read=lambda field: getattr(state(), field).cpu().numpy().astype(np.float64),
        )
    if envs.arrays != "torch":
        raise PolicyError(f"policies take no arrays of '{envs.arrays}'; make the environment with arrays=\"torch\"")
    xp, put = torch_library(envs.worlds.arousal.level)
    return Batch(
        infants,
        lambda: envs.worlds.arousal.level[:, None],
        xp,
        put,
        is_on_device=True,
        read=lambda field: getattr(state(), field),
    )


class _AssignedInfants(Sequence[Infant]):
    """The infants that stand for those in the worlds of a device now."""

    def __init__(self, envs: Any):
        self._envs = envs

    def __len__(self) -> int:
        return self._envs.num_envs

    def __getitem__(self, row: Any) -> Any:
        if row >= len(self):
            raise IndexError(row)
        return self._envs.assignment.infant(row)


def bind_random(batch: Batch) -> BatchPolicy:
    """Return the policy that draws every command uniformly from its range."""
    low, high = batch.limits()

    def act(generators: Sequence[np.random.Generator], observations: Any) -> Any:
        rows = zip(generators, low, high, strict=True)
        return batch.actions(batch.draw([generator.uniform(*limits) for generator, *limits in rows]))

    return act


def bind_zero(batch: Batch) -> BatchPolicy:
    """Return the policy that commands nothing."""
    actions = batch.actions(batch.put(np.clip(0.0, *batch.limits())))
    return lambda generators, observations: actions


def begin_here(infant: Infant) -> Observation:
    """Let an infant whose configuration was changed begin its episode there, and return what it senses.

    Other infants of its world sense that, too, as if it had been there before; their noise is drawn anew later on. A
    recording of the run keeps this as a state that was restored.
    """
    simulation = infant.simulation
    set_physics(infant.model, infant.data, physics_of(infant.model, infant.data))
    for other in simulation.infants.values():
        noise = other.noise.state
        other.schedule.reset(infant.data)
        if other is not infant:
            other.noise.state = noise
    simulation.set_state(simulation.get_state())
    return infant.observe()


def check_apart(infants: Mapping[str, Infant]) -> None:
    """Raise a PolicyError if policies have put infants of a world within each other."""
    if len(infants) < 2:
        return
    first = next(iter(infants.values()))
    roots = [infant.manifest.root_body for infant in infants.values()]
    if depths := overlaps(first.model, copy.copy(first.data), roots):
        one, other = ([*infants][index] for index in next(iter(depths)))
        raise PolicyError(f"their policies put '{one}' and '{other}' within each other; place them further apart")

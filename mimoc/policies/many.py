"""Policies of all infants of an environment: from the name of a policy, or a sum of names, to their actions."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.policies.named import (
    Loader,
    Policies,
    bound_to_many,
    limits_of,
    policies_of,
    policy_of,
    summed,
    with_silence,
)
from mimoc.policies.policy import Batch, BatchPolicy, Policy, PolicyMaker, batch_of, begin_rows, notes_of, start_again
from mimoc.policies.spec import PolicyPart, parse_policy, split_behaviours
from mimoc.runtime.batch_env import infants_of
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import Observation
from mimoc.runtime.world_env import WorldEnv


def policy_vec(policy: Policies, envs: Any, load: Loader | None = None) -> Any:
    """Return a policy for all infants of an environment, which takes observations and gives actions in its form.

    Of a vector environment, these have a row for each infant, and there is a generator for each. The law: on the CPU,
    row i of its actions is, to the bit, the action of the single infant i under the same policy, with the same
    generator and observations. On a device it is the same in single precision.

    Where episodes end, call `reset` with the rows of the infants that begin again, a boolean array of shape (n,),
    before the next action: a policy such as `reflexes` then forgets what they sensed. With the autoreset mode
    `NextStep`, an action is drawn and not used for an infant that has ended; with `SameStep` and `Disabled`, nothing is
    drawn in vain, and all is as for a single infant.

    Of a world, generators, observations and actions are by the names of infants, and `reset` takes the names of those
    that begin again. Of one infant, there is one of each, and `reset` takes nothing.

    Args:
        policy: A name, a name with its argument, or a sum of names, as for `policy_of`; or a function from a single
            environment to its policy, which acts for one infant after another. Or such policies by the names of
            infants, which in a vector environment are their numbers, as text.
        envs: The environment, of `mimoc.make`, `mimoc.make_parallel`, or `mimoc.make_vec`; on a device with arrays of
            NumPy or torch.
        load: Loads trained policies, such as `mimoc.load_policy`.

    Raises:
        UnknownNameError: If there is no such policy.
        PolicyError: If the text is no policy otherwise, or the policy is for infants on the CPU only.

    Example:
        >>> import mimoc
        >>> import numpy as np
        >>> envs = mimoc.make_vec("nine_months.yaml", num_envs=3, autoreset_mode="SameStep")
        >>> policy = mimoc.policy_vec("random+zero", envs)
        >>> generators = [np.random.default_rng(seed) for seed in range(3)]
        >>> observations, infos = envs.reset(seed=0)
        >>> for _ in range(5):
        ...     observations, rewards, ended, cut, infos = envs.step(policy(generators, observations))
        ...     policy.reset(ended | cut)
        >>> envs.close()
    """
    inside = getattr(envs, "unwrapped", envs)
    if isinstance(inside, (InfantEnv, WorldEnv)):
        policies = policies_of(infants_of("policy_vec", envs), policy, load)
        return ByName(policies) if isinstance(inside, WorldEnv) else Single(policies[""])
    batch = batch_of(inside)
    if isinstance(policy, Mapping):
        return OneByOne([*policies_of(infants_of("policy_vec", envs), policy, load).values()])
    if not isinstance(policy, str):
        return SumOfMany(batch, [_one_by_one(batch, policy, "a function of your own")])
    together, others = split_behaviours(parse_policy(policy))
    policies = [_bound(batch, part, load) for part in others]
    if together:
        text = "+".join(part.text for part in together)
        policies.insert(0, _one_by_one(batch, lambda env: policy_of(env, text), f"'{text}'"))
    return SumOfMany(batch, policies)


class Single:
    """The policy of the only infant of an environment."""

    def __init__(self, policy: Policy):
        self._policy = policy

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the action, shape (n,)."""
        return self._policy(generator, observation)

    def reset(self) -> None:
        """Begin an episode."""
        start_again(self._policy)

    def notes(self) -> tuple[str, ...]:
        """Return what the policy tells of a run in sentences."""
        return notes_of(self._policy)


class ByName:
    """Policies of the infants of a world, by name."""

    def __init__(self, policies: Mapping[str, Policy]):
        self._policies = policies

    def __call__(
        self, generators: Mapping[str, np.random.Generator], observations: Mapping[str, Observation]
    ) -> dict[str, np.ndarray]:
        """Return the action of each infant that observes something, shape (n,)."""
        return {name: self._policies[name](generators[name], seen) for name, seen in observations.items()}

    def reset(self, names: Iterable[str]) -> None:
        """Let some infants begin an episode."""
        for name in names:
            start_again(self._policies[name])


class SumOfMany:
    """Several policies of many infants at once, or one; see `mimoc.policies.named.Sum`."""

    def __init__(self, batch: Batch, policies: Sequence[BatchPolicy]):
        self._batch, self._policies = batch, tuple(policies)
        self._ages, self._limits = list[float](), ()
        self._has_voice = batch.infants[0].manifest.actuation.voice is not None
        self._joints = len(batch.infants[0].actuation.low)

    def __call__(self, generators: Sequence[np.random.Generator], observations: Any) -> Any:
        """Return the actions, shape (k, n)."""
        actions = [policy(generators, observations) for policy in self._policies]
        if self._has_voice:
            actions = [with_silence(item, self._joints) for item in actions]
        if len(actions) == 1:
            return actions[0]
        ages = [infant.age_months for infant in self._batch.infants]
        if ages != self._ages:
            limits = (np.stack(ends) for ends in zip(*map(limits_of, self._batch.infants), strict=True))
            self._ages, self._limits = ages, tuple(map(self._batch.put, limits))
        return self._batch.actions(summed(self._batch.xp, actions, *self._limits))

    def reset(self, rows: Any) -> None:
        """Let the infants of some rows, a boolean array of shape (k,), begin an episode."""
        for policy in self._policies:
            begin_rows(policy, rows)


class OneByOne:
    """Policies of single infants, which act one after the other."""

    def __init__(self, policies: Sequence[Policy]):
        self._policies = tuple(policies)

    def __call__(self, generators: Sequence[np.random.Generator], observations: Any) -> np.ndarray:
        """Return the actions, shape (k, n)."""
        rows = zip(self._policies, generators, strict=True)
        return np.stack(
            [
                policy(generator, {name: readings[row] for name, readings in observations.items()})
                for row, (policy, generator) in enumerate(rows)
            ]
        )

    def reset(self, rows: Any) -> None:
        """Let the infants of some rows begin an episode."""
        for policy, begins in zip(self._policies, rows, strict=True):
            if begins:
                start_again(policy)


def _bound(batch: Batch, part: PolicyPart, load: Loader | None) -> BatchPolicy:
    if part.kind is None or part.kind.many is None:
        return _one_by_one(batch, lambda env: policy_of(env, part.text, load), f"'{part.text}'")
    return bound_to_many(batch, part)


def _one_by_one(batch: Batch, maker: PolicyMaker, what: str) -> OneByOne:
    if batch.is_on_device:
        raise PolicyError(f"{what} acts for single infants on the CPU; make the environment without device")
    return OneByOne([maker(infant) for infant in batch.infants])

"""From the name of a policy, or a sum of names, to the policy of an infant."""

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from mimoc.base.errors import PolicyError, check_name
from mimoc.base.kinds import function_of
from mimoc.policies.behaviours.behaviour import split_knowledge
from mimoc.policies.behaviours.policy import BehaviourPolicy, NamedBehaviour
from mimoc.policies.policy import (
    Batch,
    BatchPolicy,
    OfOne,
    Policy,
    PolicyMaker,
    batch_of_one,
    begin,
    episode_limit_of,
    merged_metrics,
    metrics_of,
    notes_of,
    numbered,
    start_again,
)
from mimoc.policies.spec import (
    PolicyPart,
    needs_argument,
    parse_policies,
    parse_policy,
    split_behaviours,
    usage,
)
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import FloatArray, Observation
from mimoc.runtime.sound import VOICE_HIGH, VOICE_LOW

Loader = Callable[[str], PolicyMaker]  # Loads the trained policy in a file, as `mimoc.load_policy` does.
Policies = str | PolicyMaker | Mapping[str, str | PolicyMaker]
"""A policy of all infants of an environment, or policies by infant; see `policies_of`."""
AT_REST = "zero"


def policy_of(env: Infant, policy: str | PolicyMaker, load: Loader | None = None) -> Policy:
    """Return a policy for an environment, by its name or from what makes one.

    Args:
        env: The infant.
        policy: A name (`random`), a name with its argument (`motion:DIR`, `look_at(toy)`), the path of a trained
            policy, or a sum of these (`general_movements+reflexes`), see `Sum`, whose behaviours (`sit+look_at(toy)`)
            are one policy, see `BehaviourPolicy`; or a function from an environment to a policy.
        load: Loads trained policies, such as `mimoc.load_policy`; without it, a path is refused.

    Raises:
        UnknownNameError: If there is no such policy.
        PolicyError: If the text is no policy otherwise, or a trained policy does not fit this infant.
    """
    if not isinstance(policy, str):
        return policy(env)
    together, others = split_behaviours(parse_policy(policy))
    policies = [_bound(env, part, load) for part in others]
    labels = [part.label for part in others]
    if together:
        named = [_named_behaviour(part) for part in together]
        policies = [BehaviourPolicy(env, named), *policies]
        labels = ["behaviours", *labels]
    if env.manifest.actuation.voice:
        policies = [Silent(policy, len(env.actuation.low)) for policy in policies]
    return policies[0] if len(policies) == 1 else Sum(env, policies, labels)


def policies_of(infants: Mapping[str, Infant], policy: Policies, load: Loader | None = None) -> dict[str, Policy]:
    """Return the policy of each infant of an environment, by name: each is an object of its own.

    Args:
        infants: The infants by name.
        policy: What `policy_of` takes, for all of them, or by infant; or a text such as `anna=sit,ben=look_at(anna)`.
            Infants without a policy command nothing.
        load: Loads trained policies; see `policy_of`.

    Raises:
        UnknownNameError: If there is no such policy or infant.
        PolicyError: If the text is no policy otherwise, or a policy does not fit its infant.
    """
    return {name: policy_of(infants[name], chosen, load) for name, chosen in by_infant(policy, infants).items()}


def by_infant(policy: Policies, names: Collection[str]) -> dict[str, str | PolicyMaker]:
    """Return which policy each infant has, by name, or raise an UnknownNameError; see `policies_of`."""
    if isinstance(policy, str):
        policy = parse_policies(policy, names)
    if not isinstance(policy, Mapping):
        return dict.fromkeys(names, policy)
    for name in policy:
        check_name("name of an infant of this world", name, names)
    return {name: policy.get(name, AT_REST) for name in names}


class Sum:
    """Several policies at once: their commands are added as differences from the command at rest.

    With commands a₁ ... aₘ of m policies and the range [l, h] of each actuator, it commands

        clip(r + Σ (aᵢ - r), l, h), where r = clip(0, l, h),

    so that the policy `zero` adds nothing, to the bit. All policies draw from the same generator, one after the other
    in the order of the sum. An episode ends after the fewest steps that any of them asks for.
    """

    def __init__(self, env: Infant, policies: Sequence[Policy], labels: Sequence[str]):
        self._env = env
        self._policies = tuple(policies)
        self._labels = numbered(labels)
        self.steps_per_episode = min(map(episode_limit_of, policies))

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the action, shape (n,)."""
        actions = [policy(generator, observation) for policy in self._policies]
        return summed(np, actions, *limits_of(self._env)).astype(np.float32)

    def reset(self) -> None:
        """Let each of them begin an episode."""
        for policy in self._policies:
            start_again(policy)

    def begin(self) -> Observation | None:
        """Let that which puts the infant where its episode begins do so."""
        observed = [observation for policy in self._policies if (observation := begin(policy)) is not None]
        return observed[-1] if observed else None

    def metrics(self) -> Mapping[str, float]:
        """Return what all of them tell of a run; a name that several have stands behind the label of each."""
        return merged_metrics([metrics_of(policy) for policy in self._policies], self._labels)

    def notes(self) -> tuple[str, ...]:
        """Return what all of them tell of a run in sentences, each once."""
        return tuple(dict.fromkeys(note for policy in self._policies for note in notes_of(policy)))


def summed(xp, actions, low, high):
    """Return the sum of commands, each an array of shape (..., n), as `Sum` says; `low` and `high` are in float64."""
    rest = xp.clip(xp.zeros_like(low), low, high)
    total = rest
    for action in actions:
        total = total + (action - rest)
    return xp.clip(total, low, high)


def _bound(env: Infant, part: PolicyPart, load: Loader | None) -> Policy:
    if part.kind is None:
        if load is None:
            raise PolicyError(f"'{part.argument}': pass what mimoc.load_policy returns of it")
        return load(part.argument or "")(env)
    if part.kind.run is None:
        return OfOne(bound_to_many(batch_of_one(env), part))
    return _binding(part)(env)


def _named_behaviour(part: PolicyPart) -> NamedBehaviour:
    assert part.kind
    knowledge, argument = split_knowledge(part.kind.name, part.argument or "")
    if not argument and needs_argument(part.kind):
        raise PolicyError(f"'{part.text}': the policy '{part.kind.name}' needs more; write {usage(part.kind)}")
    return NamedBehaviour(part.label, _binding(replace(part, argument=argument or None)), knowledge)


def _binding(part: PolicyPart) -> Callable[[Any], Any]:
    assert part.kind
    assert part.kind.run
    bind = function_of(part.kind.run, "bind")
    return bind if part.argument is None else lambda bound_to: bind(bound_to, part.argument)


def bound_to_many(batch: Batch, part: PolicyPart) -> BatchPolicy:
    """Return a policy that acts for many infants at once."""
    assert part.kind
    assert part.kind.many
    bind = function_of(part.kind.many, "bind_many")
    return bind(batch) if part.argument is None else bind(batch, part.argument)


class Silent:
    """A policy whose last two commands, those of the voice, are 0 if it has none for them."""

    def __init__(self, policy: Policy, joints: int):
        """Take a policy, with all that it has besides; *joints* is the number of commands that are not the voice's."""
        self._policy, self._joints = policy, joints

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the action, shape (n + 2,)."""
        return with_silence(self._policy(generator, observation), self._joints)

    def __getattr__(self, name: str) -> Any:
        if name == "_policy":
            raise AttributeError(name)
        return getattr(self._policy, name)


def with_silence(actions: Any, joints: int) -> Any:
    """Return actions, shape (..., n), with a silent voice behind them, unless they have commands for it."""
    if actions.shape[-1] != joints:
        return actions
    return np.concatenate([actions, np.zeros((*actions.shape[:-1], len(VOICE_LOW)), actions.dtype)], axis=-1)


def limits_of(env: Infant) -> tuple[FloatArray, FloatArray]:
    """Return the smallest and the largest commands of an infant, those of its voice included."""
    low, high = env.actuation.low, env.actuation.high
    if env.manifest.actuation.voice is None:
        return low, high
    return np.concatenate([low, VOICE_LOW]), np.concatenate([high, VOICE_HIGH])

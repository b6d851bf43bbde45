"""From the name of a policy, or a sum of names, to the policy of an infant."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.base.kinds import function_of
from mimoc.policies.policy import Policy, PolicyMaker, episode_limit_of, metrics_of, start_again
from mimoc.policies.spec import PolicyPart, parse_policy
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import Observation

Loader = Callable[[str], PolicyMaker]
"""Loads the trained policy in a file, as `mimoc.load_policy` does."""


def policy_of(env: InfantEnv, policy: str | PolicyMaker, load: Loader | None = None) -> Policy:
    """Return a policy for an environment, by its name or from what makes one.

    Args:
        env: The infant.
        policy: A name (`random`), a name with its argument (`motion:DIR`), the path of a trained policy, or a sum of
            these (`general_movements+reflexes`), see `Sum`; or a function from an environment to a policy.
        load: Loads trained policies, such as `mimoc.load_policy`; without it, a path is refused.

    Raises:
        UnknownNameError: If there is no such policy.
        PolicyError: If the text is no policy otherwise, or a trained policy does not fit this infant.
    """
    if not isinstance(policy, str):
        return policy(env)
    parts = parse_policy(policy)
    policies = [_bound(env, part, load) for part in parts]
    return policies[0] if len(policies) == 1 else Sum(env, policies, [part.label for part in parts])


class Sum:
    """Several policies at once: their commands are added as differences from the command at rest.

    With commands a₁ ... aₘ of m policies and the range [l, h] of each actuator, it commands

        clip(r + Σ (aᵢ - r), l, h), where r = clip(0, l, h),

    so that the policy `zero` adds nothing, to the bit. All policies draw from the same generator, one after the other
    in the order of the sum. An episode ends after the fewest steps that any of them asks for.
    """

    def __init__(self, env: InfantEnv, policies: Sequence[Policy], labels: Sequence[str]):
        """Add policies of one infant, each with what it is called where metrics have the same name."""
        self._env, self._policies, self._labels = env, tuple(policies), numbered(labels)
        self.steps_per_episode = min(map(episode_limit_of, policies))

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the action, shape (n,)."""
        actuation = self._env.actuation
        actions = [policy(generator, observation) for policy in self._policies]
        return summed(np, actions, actuation.low, actuation.high).astype(np.float32)

    def reset(self) -> None:
        """Let each of them begin an episode."""
        for policy in self._policies:
            start_again(policy)

    def metrics(self) -> Mapping[str, float]:
        """Return what all of them tell of a run; a name that several have stands behind the label of each."""
        return merged_metrics([metrics_of(policy) for policy in self._policies], self._labels)


def summed(xp, actions, low, high):
    """Return the sum of commands, each an array of shape (..., n), as `Sum` says; `low` and `high` are in float64."""
    rest = xp.clip(xp.zeros_like(low), low, high)
    total = rest
    for action in actions:
        total = total + (action - rest)
    return xp.clip(total, low, high)


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


def _bound(env: InfantEnv, part: PolicyPart, load: Loader | None) -> Policy:
    """Return one policy for an environment."""
    if part.kind is None:
        if load is None:
            raise PolicyError(f"'{part.argument}': pass what mimoc.load_policy returns of it")
        return load(part.argument or "")(env)
    bind = function_of(part.kind.run, "bind")
    return bind(env) if part.argument is None else bind(env, part.argument)

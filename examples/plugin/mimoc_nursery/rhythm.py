"""A policy that moves every actuator in a steady rhythm, each with a random phase."""

from typing import TYPE_CHECKING

import numpy as np

from mimoc.schema.kinds import PolicyKind

if TYPE_CHECKING:
    from mimoc.policies.policy import Policy
    from mimoc.runtime.env import InfantEnv

KIND = PolicyKind("rhythm", "moves every actuator once a second, each with a random phase", "mimoc_nursery.rhythm")

FREQUENCY_HZ = 1.0


def bind(env: "InfantEnv") -> "Policy":
    """Return the policy for an environment."""
    low, high = env.actuation.low, env.actuation.high
    step_s = env.manifest.step_ms / 1000
    phases: list[np.ndarray] = []
    steps = 0

    def act(generator: np.random.Generator, observation: dict[str, np.ndarray]) -> np.ndarray:
        nonlocal steps
        if not phases:
            phases.append(generator.uniform(0.0, 2 * np.pi, len(low)))
        share = 0.5 + 0.5 * np.sin(2 * np.pi * FREQUENCY_HZ * steps * step_s + phases[0])
        steps += 1
        return (low + share * (high - low)).astype(np.float32)

    return act

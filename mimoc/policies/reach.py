"""A policy that reaches for random targets by inverse dynamics."""

from mimoc.control import Reaching
from mimoc.policies.policy import Policy
from mimoc.runtime.env import InfantEnv


def bind(env: InfantEnv) -> Policy:
    """Return the policy for an environment.

    Raises:
        ControlError: If the infant is driven by servos, or lacks what reaches.
    """
    return Reaching(env)

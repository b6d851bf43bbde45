"""Trained policies in files, whatever they were trained with."""

from pathlib import Path

from mimoc.base.classes import PATH, takes
from mimoc.policies.network import load_network
from mimoc.policies.policy import PolicyMaker
from mimoc.policies.policy_file import read_policy


@takes("the path of a trained policy", *PATH)
def load_policy(path: str | Path) -> PolicyMaker:
    """Load a trained policy; return a function that binds it to an environment, for `Run` and `evaluate`.

    Loading a policy runs no code from its file. The returned function raises a PolicyError for an infant whose
    observations or actuators differ from those of the trained infant. A policy that was trained on a device is computed
    by NumPy alone, and acts for an infant that observes more, too; one that was trained on the CPU needs
    Stable-Baselines3.

    Raises:
        PolicyError: If the file is not a policy trained by mimoc.
        MissingExtraError: If it needs Stable-Baselines3, which is not installed.

    Example:
        >>> import mimoc
        >>> policy = mimoc.load_policy("runs/reach/policy.zip")
        >>> env = mimoc.make("reach.yaml", max_episode_steps=5)
        >>> len(mimoc.evaluate(env, policy, episodes=1))
        1
    """
    file = read_policy(path)
    if maker := load_network(file):
        return maker
    from mimoc.training import load_agent

    return load_agent(file)

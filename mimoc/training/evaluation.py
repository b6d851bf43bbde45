"""Evaluation of a policy, episode by episode."""

from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import TrainingError, UnknownNameError
from mimoc.policies.named import Policies
from mimoc.policies.policy import PolicyMaker
from mimoc.policies.policy_file import load_network, read_policy
from mimoc.policies.rollout import Rollout
from mimoc.runtime.infant import Infant
from mimoc.runtime.quantities import EpisodeResult
from mimoc.runtime.sense import FloatArray


def evaluate(
    env: Any,
    policy: Policies,
    episodes: int,
    seed: int = 0,
    follow: str | None = None,
    steps_per_episode: int | None = None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Any:
    """Run a policy for a number of episodes and return their results.

    Episode i is reset with `seed + i`, so that all policies start from the same initial states.

    Args:
        env: An environment from `mimoc.make`, `make_parallel` or, on the CPU, `make_vec`; it is not closed. A vector
            environment runs its episodes side by side, episode i with infant i % n. If its infants are alike, the
            result is the same, to the bit, as of one infant; in worlds of several, episode i is of world i % n.
        policy: Name of a policy, such as `random`, the path of a trained one, a sum of these
            (`policy.zip+reflexes`), or a trained policy from `load_policy`; in a world also a policy for each infant by
            name, where those that are not named command nothing.
        episodes: Number of episodes.
        seed: Seed of the first episode.
        follow: Name of a body, such as `right_fingers`, whose path is recorded.
        steps_per_episode: Control steps after which an episode ends, unless the task ends it earlier; by default as in
            the training of the policy, or as `max_episode_steps` of the environment says.
        progress: Called with the number of episodes done, and of all.

    Returns:
        A list of `EpisodeResult`, one for each seed; of worlds, a dictionary with the list of each infant, by its name.

    Raises:
        UnknownNameError: If there is no such policy, infant or body.
        PolicyError: If the policy does not fit an infant.
        TrainingError: If nothing ends the episodes of an infant.
        TypeError: If it is no environment of mimoc's on the CPU.

    Example:
        >>> import mimoc
        >>> env = mimoc.make("reach.yaml", max_episode_steps=5)
        >>> episodes = mimoc.evaluate(env, "random", episodes=2)
        >>> [episode.steps for episode in episodes]
        [5, 5]
    """
    limit = {"steps_per_episode": steps_per_episode, "load": load_policy}
    run = Rollout(env, policy, seed=seed, episodes=episodes, function="evaluate", **limit)
    bodies = {name: _body(infant, follow) if follow else None for name, infant in run.infants.items()}
    for name, infant in run.infants.items():
        if not run.ends(name):
            raise TrainingError(
                f"the episodes of '{infant.manifest.name}' do not end; give steps_per_episode, or set task.steps in "
                "its spec"
            )
    names = {name: run.name_of(name) for name in run.infants}
    results = dict[tuple[int, str], EpisodeResult]()
    paths_m = defaultdict[str, list[FloatArray]](list)
    for step in run.go():
        if body := bodies[step.infant]:
            paths_m[step.infant].append(run.infants[step.infant].data.body(body).xpos.copy())
        if step.ended:
            path_m = np.array(paths_m.pop(step.infant)) if follow else None
            results[step.episode, step.infant] = run.result_of(step, path_m)
            progress(len(results), episodes * len(set(names.values())))
    by_name: dict[str, list[EpisodeResult]] = {name: [] for name in names.values()}
    for (_, name), result in sorted(results.items(), key=lambda item: item[0][0]):
        by_name[names[name]].append(result)
    return by_name.get("", []) if "" in names.values() else by_name


def _body(infant: Infant, name: str) -> str:
    model, of_infant = infant.model, infant.manifest.of_infant
    names = [model.body(index).name for index in range(model.nbody)]
    bodies = {of_infant(body): body for body in names}
    if name not in bodies:
        raise UnknownNameError("body of this infant", name, bodies)
    return bodies[name]


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

"""`mimoc evaluate`."""

from contextlib import closing
from typing import Annotated, Any

import typer

from mimoc.base.errors import counted
from mimoc.cli import worlds
from mimoc.cli.arguments import InfantPath, import_object, load_infant
from mimoc.cli.run import ChosenPolicies, OwnTask, open_env, policies_by_infant

Episodes = Annotated[int, typer.Option(min=1, help="Number of episodes; episode i begins with seed + i.")]
Seed = Annotated[int, typer.Option(min=0, help="Random seed of the first episode.")]
Envs = Annotated[
    int, typer.Option(min=1, max=1024, help="Episodes that run side by side; the result is the same for any number.")
]
StepsPerEpisode = Annotated[
    int | None,
    typer.Option(min=1, help="Control steps after which an episode ends; default: those of the task or the policy."),
]


def evaluate(
    infant: InfantPath,
    policy: ChosenPolicies = None,
    episodes: Episodes = 10,
    seed: Seed = 0,
    envs: Envs = 1,
    steps_per_episode: StepsPerEpisode = None,
    task: OwnTask = None,
) -> None:
    """Run the infants under a policy in episodes with seeds of their own, and print how well they did."""
    from mimoc import make_vec
    from mimoc.bundle.world import WorldBundle
    from mimoc.cli import console
    from mimoc.runtime.infants import infants_of
    from mimoc.runtime.quantities.measuring import measure
    from mimoc.training.evaluation import evaluate as run_episodes

    shown: Any = worlds.find_world(infant) or load_infant(infant)
    side_by_side = min(envs, episodes)
    if side_by_side == 1:
        env: Any = open_env(shown, task)
    else:
        own: dict[str, Any] = {}
        rows = side_by_side * len(shown.infants) if isinstance(shown, WorldBundle) else side_by_side
        if task and isinstance(shown, WorldBundle):
            own = {"tasks": {name: import_object(task) for name in shown.infants}}
        elif task:
            own = {"task": import_object(task)}
        env = make_vec(shown, rows, **own)
    with closing(env), console.progress("evaluating") as show:
        chosen = policies_by_infant(policy, infant, None, infants_of("evaluate", env))
        done = run_episodes(env, chosen, episodes, seed, None, steps_per_episode, progress=show)
    by_infant = done if isinstance(done, dict) else {"": done}
    measured = {name: measure("episode", "run", outcomes) for name, outcomes in by_infant.items()}
    console.print_measures(measured, f"{counted(episodes, 'episode')}, seeds {seed} to {seed + episodes - 1}")

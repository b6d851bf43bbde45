"""`mimoc train` and `mimoc evaluate`: policies that learn, and how well they do."""

from contextlib import closing
from pathlib import Path
from typing import Annotated, Any

import typer

from mimoc.base.errors import counted
from mimoc.cli.arguments import InfantPath, find_world, import_object, load_infant
from mimoc.cli.run import ChosenPolicies, OwnTask as EvaluatedTask, open_env, policies_by_infant
from mimoc.cli.terminal import resumable

CheckpointEvery = Annotated[
    int | None,
    typer.Option(
        min=1,
        help="Steps between checkpoints: the most that a kill can lose; default: 20480, or an episode, "
        "on a device four, if longer.",
    ),
]
StepsPerEpisode = Annotated[
    int | None,
    typer.Option(min=1, help="Control steps after which an episode is truncated; default: those of the task, or 500."),
]
Assignments = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Set a hyperparameter, as in gamma=0.99; repeatable."),
]
Processes = Annotated[
    bool | None,
    typer.Option(
        "--processes/--one-process",
        help="Run each environment in a process of its own, or one after another; default: all together.",
    ),
]
Threads = Annotated[
    int | None,
    typer.Option(min=1, help="Threads that share the work of all together; default: as many as may be used."),
]
OwnTask = Annotated[
    str | None,
    typer.Option(metavar="MODULE:CLASS", help="Take rewards from a class of your own, in a module of this folder."),
]
Steps = Annotated[int, typer.Option(min=1, help="Control steps to train for, summed over all environments.")]
Force = Annotated[bool, typer.Option("--force", help="Discard the training run in the folder and start over.")]
Grow = Annotated[
    str | None,
    typer.Option(metavar="A:B", help="Let the infant have ages from A to B months over the training, as in 6:12."),
]
Schedule = Annotated[
    str, typer.Option(help="Order of the ages of --grow: grown, adult (only the oldest), reversed or shuffled.")
]
Record = Annotated[
    Path | None, typer.Option(metavar="DIR", help="Record all episodes in this folder (needs `mimoc[record]`).")
]
GrowSteps = Annotated[
    int | None, typer.Option(min=1, help="Control steps that growth takes, summed over all environments; default: all.")
]
Device = Annotated[
    str,
    typer.Option(help="Where the infants live and learn: cpu, cuda:0 (needs `mimoc[gpu]`), or warp:cpu to try that."),
]


def train(
    infant: InfantPath,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="RUN", help="Folder of the training run.")],
    algo: Annotated[str, typer.Option(help="Learning algorithm: ppo or sac.")] = "ppo",
    steps: Steps = 500_000,
    seed: Annotated[int, typer.Option(min=0, help="Random seed; the same seed gives the same result.")] = 0,
    envs: Annotated[int, typer.Option(min=1, max=65536, help="Number of infants that learn side by side.")] = 8,
    steps_per_episode: StepsPerEpisode = None,
    checkpoint_every: CheckpointEvery = None,
    assignments: Assignments = None,
    threads: Threads = None,
    processes: Processes = None,
    task: OwnTask = None,
    grow: Grow = None,
    schedule: Schedule = "grown",
    grow_steps: GrowSteps = None,
    record: Record = None,
    device: Device = "cpu",
    force: Force = False,
) -> None:
    """Train a policy for an infant, or one for all of a world; run the same command again to resume it."""
    from mimoc import training
    from mimoc.cli import training_output
    from mimoc.training.settings import check_envs, parse

    others: dict[str, Any] = {"grow": grow, "schedule": schedule, "grow_steps": grow_steps, "record": record}
    others |= {"threads": threads, "processes": processes, "force": force, "device": device}
    others |= {"steps_per_episode": steps_per_episode, "checkpoint_every": checkpoint_every}
    check_envs(envs, device)
    bundle: Any = find_world(infant) or load_infant(infant)
    others |= {"hyper": parse(algo, assignments or [], device), "task": import_object(task) if task else None}
    with training_output.shown() as show, resumable(out / "policy.zip"):
        others |= {"progress": show.report, "on_row": show.on_row}
        done = training.train(bundle, out, algo=algo, steps=steps, seed=seed, envs=envs, **others)
    training_output.print_training(done, out, task)


Episodes = Annotated[int, typer.Option(min=1, help="Number of episodes; episode i begins with seed + i.")]
FirstSeed = Annotated[int, typer.Option(min=0, help="Random seed of the first episode.")]
SideBySide = Annotated[
    int, typer.Option(min=1, max=1024, help="Episodes that run side by side; the result is the same for any number.")
]
EvaluatedSteps = Annotated[
    int | None,
    typer.Option(min=1, help="Control steps after which an episode ends; default: those of the task or the policy."),
]


def evaluate(
    infant: InfantPath,
    policy: ChosenPolicies = None,
    episodes: Episodes = 10,
    seed: FirstSeed = 0,
    envs: SideBySide = 1,
    steps_per_episode: EvaluatedSteps = None,
    task: EvaluatedTask = None,
) -> None:
    """Run the infants under a policy in episodes with seeds of their own, and print how well they did."""
    from mimoc import make_vec
    from mimoc.bundle.world import WorldBundle
    from mimoc.cli import console
    from mimoc.runtime.batch.vector_env import infants_of
    from mimoc.runtime.quantities.measuring import measure
    from mimoc.training.evaluation import evaluate as run_episodes

    shown: Any = find_world(infant) or load_infant(infant)
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

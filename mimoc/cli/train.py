"""`mimoc train`."""

from pathlib import Path
from typing import Annotated, Any

import typer

from mimoc.cli import worlds
from mimoc.cli.arguments import InfantPath, import_object, load_infant
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
    bundle: Any = worlds.find_world(infant) or load_infant(infant)
    others |= {"hyper": parse(algo, assignments or [], device), "task": import_object(task) if task else None}
    with training_output.shown() as show, resumable(out / "policy.zip"):
        others |= {"progress": show.report, "on_row": show.on_row}
        done = training.train(bundle, out, algo=algo, steps=steps, seed=seed, envs=envs, **others)
    training_output.print_training(done, out, task)

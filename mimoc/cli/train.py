"""`mimoc train`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.arguments import InfantPath
from mimoc.cli.custom import import_object
from mimoc.cli.exit_codes import resumable
from mimoc.cli.infants import load_infant

EXAMPLE = "Example:  mimoc train configs/reach.yaml -o runs/reach --algo ppo --steps 4096"

CheckpointEvery = Annotated[
    int, typer.Option("--checkpoint-every", min=1, help="Steps between checkpoints: the most that a kill can lose.")
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
    typer.Option("--threads", min=1, help="Threads that share the work; default: as many as may be used."),
]
Force = Annotated[bool, typer.Option("--force", help="Discard the training run in the folder and start over.")]
OwnTask = Annotated[
    str | None,
    typer.Option(
        "--task", metavar="MODULE:CLASS", help="Take rewards from a class of your own, in a module of this folder."
    ),
]


def train(
    infant: InfantPath,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="RUN", help="Folder of the training run.")],
    algo: Annotated[str, typer.Option("--algo", help="Learning algorithm: ppo or sac.")] = "ppo",
    steps: Annotated[
        int, typer.Option("--steps", min=1, help="Control steps to train for, summed over all environments.")
    ] = 500_000,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Random seed; the same seed gives the same result.")] = 0,
    envs: Annotated[int, typer.Option("--envs", min=1, max=1024, help="Number of parallel environments.")] = 8,
    every: CheckpointEvery = 20_480,
    assignments: Assignments = None,
    threads: Threads = None,
    processes: Processes = None,
    task: OwnTask = None,
    force: Force = False,
) -> None:
    """Train a policy for the infant; run the same command again to resume an interrupted training."""
    from mimoc import training
    from mimoc.cli import console
    from mimoc.training import hyperparameters

    chosen, bundle = hyperparameters.parse(algo, assignments or []), load_infant(infant)
    with console.progress("training") as show, resumable():
        done = training.train(
            bundle,
            out,
            algo=algo,
            steps=steps,
            seed=seed,
            envs=envs,
            checkpoint_every=every,
            hyper=chosen,
            threads=threads,
            processes=processes,
            force=force,
            progress=show,
            task=import_object(task) if task else None,
        )
    console.print_training(done)
    print(f"{out}: see {out / 'curve.png'}, or try: mimoc run {out / 'bundle'} --policy {done.policy}")

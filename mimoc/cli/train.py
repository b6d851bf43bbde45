"""`mimoc train`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.arguments import InfantPath
from mimoc.cli.exits import can_go_on
from mimoc.cli.infants import take_bundle

EXAMPLE = "Example:  mimoc train configs/reach.yaml -o runs/reach --algo ppo --steps 4096"

Knobs = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="A hyper-parameter, such as gamma=0.99; a wrong name lists them."),
]
Processes = Annotated[
    bool | None,
    typer.Option(
        "--processes/--one-process",
        help="Whether each infant has a process of its own; by itself, where that is faster.",
    ),
]


def train(
    infant: InfantPath,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="RUN", help="Folder of the training.")],
    algo: Annotated[str, typer.Option("--algo", help="How it learns: ppo or sac.")] = "ppo",
    steps: Annotated[
        int, typer.Option("--steps", min=1, help="Control steps to learn from, of all infants.")
    ] = 500_000,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed: the same learns the same.")] = 0,
    envs: Annotated[int, typer.Option("--envs", min=1, max=1024, help="Infants that act at a time.")] = 8,
    every: Annotated[
        int, typer.Option("--checkpoint-every", min=1, help="Steps between checkpoints; a kill loses at most these.")
    ] = 20_480,
    knobs: Knobs = None,
    processes: Processes = None,
    force: Annotated[bool, typer.Option("--force", help="Begin anew what is in the folder.")] = False,
) -> None:
    """Train the infant; the same command again goes on with a training that was interrupted."""
    from mimoc import training
    from mimoc.cli import console
    from mimoc.training import hyper

    chosen, bundle = hyper.read(algo, knobs or []), take_bundle(infant)
    with console.progress("training") as show, can_go_on():
        done = training.train(
            bundle,
            out,
            algo=algo,
            steps=steps,
            seed=seed,
            envs=envs,
            checkpoint_every=every,
            hyper=chosen,
            processes=processes,
            force=force,
            progress=show,
        )
    console.print_training(done)
    print(f"{out}: see {out / 'curve.png'}, or try: mimoc run {out / 'bundle'} --policy {done.policy}")

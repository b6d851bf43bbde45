"""`mimoc run`."""

from contextlib import closing
from typing import TYPE_CHECKING, Annotated

import typer

from mimoc.cli.arguments import InfantPath
from mimoc.cli.infants import take_bundle

if TYPE_CHECKING:
    from mimoc.runtime.rollout import PolicyMaker

EXAMPLE = "Example:  mimoc run out/nine_months --policy random --steps 500 --seed 1"


def run(
    infant: InfantPath,
    policy: Annotated[
        str,
        typer.Option(
            "--policy",
            help="What acts: random, zero, reach (by inverse dynamics; not for servos), or a training's policy.zip.",
        ),
    ] = "random",
    steps: Annotated[int, typer.Option("--steps", min=1, help="Control steps to run.")] = 1000,
    seed: Annotated[
        int, typer.Option("--seed", min=0, help="Of the policy and the episodes: the same gives the same.")
    ] = 0,
    window: Annotated[bool, typer.Option("--window", help="Show it in a window, in real time.")] = False,
) -> None:
    """Run the infant under a policy, with progress and a closing summary."""
    from mimoc import console
    from mimoc.runtime.env import InfantEnv
    from mimoc.runtime.rollout import Run

    with closing(InfantEnv(take_bundle(infant), render_mode="human" if window else None)) as env:
        running = Run(env, _read_policy(policy), seed)
        with console.progress("running") as show:
            for step in range(steps):
                running.step()
                show(step + 1, steps)
    console.print_run(running.summary())


def _read_policy(policy: str) -> "str | PolicyMaker":
    """Return what the name of a file makes act; any other name as it is."""
    if not policy.endswith(".zip"):
        return policy
    from mimoc.training import load_policy

    return load_policy(policy)

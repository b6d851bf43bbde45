"""`mimoc run`."""

import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mimoc.cli.arguments import InfantPath
from mimoc.cli.infants import take_bundle
from mimoc.errors import MimocError

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from mimoc.recording.record import Look
    from mimoc.runtime.rollout import PolicyMaker, Run

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
    video: Annotated[
        Path | None, typer.Option("--video", metavar="FILE", help="Film it, as an .mp4 (`mimoc[record]`) or a .gif.")
    ] = None,
    eyes: Annotated[bool, typer.Option("--eyes", help="Show beside the film what its eyes see.")] = False,
    fps: Annotated[int, typer.Option("--fps", min=1, max=100, help="Pictures a second of the film.")] = 25,
    size: Annotated[int, typer.Option("--size", min=64, max=2160, help="Height of the film, pixels.")] = 360,
) -> None:
    """Run the infant under a policy, with progress and a closing summary; film it in real time."""
    from mimoc import recording
    from mimoc.cli import console
    from mimoc.runtime.env import InfantEnv
    from mimoc.runtime.rollout import Run

    if eyes and not video:
        raise MimocError("--eyes shows what the infant sees beside its film; say where that goes, with --video FILE")
    if video:
        recording.check_video(video)
    with closing(InfantEnv(take_bundle(infant), render_mode="human" if window else None)) as env:
        running = Run(env, _read_policy(policy), seed)
        film = recording.filming(running, video, eyes=eyes, rate_hz=fps, height_px=size) if video else nullcontext()
        _run(running, steps, film, video)
    console.print_run(running.summary())
    if video:
        print(video)


def _run(running: "Run", steps: int, film: "AbstractContextManager[Look | None]", video: Path | None) -> None:
    """Take some steps, shown as progress, and film them if there is a film."""
    from mimoc.cli import console

    with _kept(video), console.progress("running") as show, film as look:
        for step in range(steps):
            running.step()
            if look:
                look()
            show(step + 1, steps)


@contextmanager
def _kept(video: Path | None) -> Iterator[None]:
    """Say, where Ctrl-C ends a film, that what was filmed is there."""
    try:
        yield
    except KeyboardInterrupt:
        if video:
            print(f"stopped; {video} shows what happened until then", file=sys.stderr)
        raise


def _read_policy(policy: str) -> "str | PolicyMaker":
    """Return what the name of a file makes act; any other name as it is."""
    if not policy.endswith(".zip"):
        return policy
    from mimoc.training import load_policy

    return load_policy(policy)

"""`mimoc experiment`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.exits import can_go_on

EXAMPLE = "Example:  mimoc experiment growth -o out/growth --quick"


def experiment(
    name: Annotated[str, typer.Argument(metavar="NAME", help="growth, strength, acuity, delays, inverse, rooms.")],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="DIR", help="Folder for tables, pictures and page.")],
    quick: Annotated[
        bool, typer.Option("--quick", help="Fewer ages, seeds or steps: seconds, or minutes for delays.")
    ] = False,
) -> None:
    """Repeat an experiment of the paper: CSV, PNG, and a page with what was measured next to what the paper says."""
    from mimoc import experiments
    from mimoc.cli import console

    with console.progress(name) as show, can_go_on():
        page = experiments.run_experiment(name, out, quick=quick, progress=show)
    print(page)

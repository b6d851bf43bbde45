"""`mimoc experiment`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.exit_codes import resumable
from mimoc.cli.printable import printable

EXAMPLE = "Example:  mimoc experiment growth -o out/growth --quick"


def experiment(
    name: Annotated[
        str,
        typer.Argument(
            metavar="NAME", help="One of: growth, strength, acuity, delays, inverse, rooms, development, growing."
        ),
    ],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="DIR", help="Folder for tables, figures and report.")],
    quick: Annotated[
        bool,
        typer.Option("--quick", help="Fewer ages, seeds or steps: takes seconds, or minutes for delays and growing."),
    ] = False,
) -> None:
    """Reproduce an experiment of the paper: tables (CSV), figures (PNG), and a report that compares the results."""
    from mimoc import experiments
    from mimoc.cli import console

    with console.progress(name) as show, resumable():
        page = experiments.run_experiment(name, out, quick=quick, progress=show)
    print(printable(page))

"""`mimoc validate`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.exits import FAILED_CHECK
from mimoc.errors import UnknownNameError

EXAMPLE = "Example:  mimoc validate --against who --plot growth.png"


def validate(
    spec: Annotated[
        Path | None, typer.Argument(metavar="[SPEC]", help="Infant to grow from 0 to 24 months; the average child.")
    ] = None,
    against: Annotated[str, typer.Option("--against", help="Growth standard: who.")] = "who",
    as_json: Annotated[bool, typer.Option("--json", help="Print the numbers as JSON.")] = False,
    plot: Annotated[Path | None, typer.Option("--plot", metavar="FILE.png", help="Draw growth against WHO.")] = None,
) -> None:
    """Compare the compiled infant with WHO's growth standards, month by month; exit 1 if it is off by over one SD."""
    from mimoc import console, pipeline, validation

    if against != "who":
        raise UnknownNameError("growth standard", against, ["who"])
    infant = pipeline.load_spec(spec) if spec else None
    with console.progress("growing") as show:
        report = validation.grow_against_who(infant, progress=show)
    if plot:
        from mimoc.plot import plot_growth

        plot_growth(report.series, plot)
    print(json.dumps(report.to_data(), indent=1)) if as_json else console.print_growth(report)
    if not report.within_one_sd:
        raise typer.Exit(FAILED_CHECK)

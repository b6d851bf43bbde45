"""`mimoc validate`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.exit_codes import FAILED_CHECK
from mimoc.cli.infants import load_spec
from mimoc.errors import UnknownNameError

EXAMPLE = "Example:  mimoc validate --against who --plot growth.png"


def validate(
    spec: Annotated[
        Path | None,
        typer.Argument(
            metavar="SPEC",
            help="Spec of the infant, or `-` for standard input; default: the average child.",
        ),
    ] = None,
    against: Annotated[str, typer.Option("--against", help="Growth standard: who.")] = "who",
    as_json: Annotated[bool, typer.Option("--json", help="Print the numbers as JSON.")] = False,
    plot: Annotated[
        Path | None,
        typer.Option("--plot", metavar="FILE", help="Plot growth against WHO: .png, .svg, .pdf, .jpg or .webp."),
    ] = None,
) -> None:
    """Compare the infant with WHO's growth standards at 0 to 24 months; exit code 1 if it deviates by over one SD."""
    from mimoc.cli import console
    from mimoc.compiler import validation
    from mimoc.render.plots import check_plot_name, plot_growth

    if against != "who":
        raise UnknownNameError("growth standard", against, ["who"])
    if plot:
        check_plot_name(plot)
    infant = load_spec(spec) if spec else None
    with console.progress("growing") as show:
        report = validation.grow_against_who(infant, progress=show)
    if plot:
        plot_growth(report.series, plot)
    print(json.dumps(report.to_data(), indent=1)) if as_json else console.print_growth(report)
    if not report.within_one_sd:
        raise typer.Exit(FAILED_CHECK)

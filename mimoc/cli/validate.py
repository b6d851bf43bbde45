"""`mimoc validate`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.exit_codes import FAILED_CHECK
from mimoc.cli.infants import load_spec
from mimoc.cli.validations import VALIDATIONS
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
    against: Annotated[str, typer.Option("--against", help=f"What to compare with: {', '.join(VALIDATIONS)}.")] = "who",
    as_json: Annotated[bool, typer.Option("--json", help="Print the numbers as JSON.")] = False,
    plot: Annotated[
        Path | None,
        typer.Option("--plot", metavar="FILE", help="Plot the comparison: .png, .svg, .pdf, .jpg or .webp."),
    ] = None,
    delays: Annotated[
        bool, typer.Option("--delays", help="Milestones with the infant's own delays of senses and commands.")
    ] = False,
) -> None:
    """Compare the infant, grown to 0 to 24 months, with children; exit code 1 if it deviates too much.

    - `who`: length, weight and circumferences by WHO's growth standards for its sex: within 0.01 SD of what the spec
      asks for, and of the average child, within one SD of the mean of boys and girls.
    - `milestones`: the ages from which on it holds up its head, sits, stands and so on, in the windows of real infants.
    - `anthrokids`: all measurements of the AnthroKids survey, taken on the compiled body, within 4 % of their means,
      as scaled by the spec.
    """
    from mimoc.cli import console
    from mimoc.render.plots.file import check_plot_name, write_sheet

    if against not in VALIDATIONS:
        raise UnknownNameError("comparison", against, list(VALIDATIONS))
    if delays and against != "milestones":
        raise typer.BadParameter("only milestones depend on delays; use it with --against milestones")
    if plot:
        check_plot_name(plot)
    infant = load_spec(spec) if spec else None
    with console.progress("growing") as show:
        findings = VALIDATIONS[against](infant, show, **({"delays": True} if delays else {}))
    if plot:
        write_sheet(findings.sheet(), plot)
    print(json.dumps(findings.data, indent=1)) if as_json else findings.show()
    if not findings.passed:
        raise typer.Exit(FAILED_CHECK)

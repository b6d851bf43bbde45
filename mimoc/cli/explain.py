"""`mimoc explain`."""

from typing import Annotated

import typer

from mimoc.cli.arguments import InfantPath
from mimoc.cli.infants import load_infant

EXAMPLE = "Example:  mimoc explain out/nine_months body.left_foot.mass"


def explain(
    infant: InfantPath,
    key: Annotated[
        str | None,
        typer.Argument(
            metavar="NUMBER",
            help="Name of the number, such as `actuator.act:left_elbow.gear`, or part of it: `weight`, `left_foot`, "
            "`toy1`, `*.mass`. Several matches are listed with their values; without a name, all numbers are listed.",
        ),
    ] = None,
) -> None:
    """Explain where a number comes from: table row, growth curve, rule, XML attribute."""
    from mimoc.cli import console
    from mimoc.compiler.explain import contents, explain, find, legend

    bundle = load_infant(infant)
    if key is None:
        console.print_contents(contents(bundle))
        return
    found = find(bundle, key)
    if len(found) == 1:
        explanation = explain(bundle, *found)
        console.print_explanation(explanation, legend(explanation))
    else:
        console.print_numbers(found)

"""`mimoc explain`."""

from typing import Annotated

import typer

from mimoc.cli.arguments import InfantPath
from mimoc.cli.infants import take_bundle

EXAMPLE = "Example:  mimoc explain out/nine_months body.left_foot.mass"


def explain(
    infant: InfantPath,
    key: Annotated[
        str | None,
        typer.Argument(
            metavar="NUMBER",
            help="Its name, `actuator.act:left_elbow.gear`, or any part of that: `weight`, `left_foot`, `toy1`, "
            "`*.mass`. Several matches are listed with their values; none given, all that can be asked is listed.",
        ),
    ] = None,
) -> None:
    """Say where a number comes from: table row, growth curve, rule, XML attribute."""
    from mimoc.cli import console
    from mimoc.compiler.explain import contents, explain, find

    bundle = take_bundle(infant)
    if key is None:
        console.print_contents(contents(bundle))
        return
    found = find(bundle, key)
    if len(found) == 1:
        console.print_explanation(explain(bundle, *found))
    else:
        console.print_numbers(found)

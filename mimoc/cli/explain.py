"""`mimoc explain`."""

from typing import Annotated

import typer

from mimoc.cli.arguments import BundlePath

EXAMPLE = "Example:  mimoc explain out/nine_months body.left_foot.mass"


def explain(
    out: BundlePath,
    key: Annotated[str, typer.Argument(metavar="KEY", help="A number: `actuator.act:left_elbow.gear`, ...")],
) -> None:
    """Say where a number comes from: table row, growth curve, rule, XML attribute."""
    from mimoc import bundle, console
    from mimoc.explain import explain

    console.print_explanation(explain(bundle.read_bundle(out), key))

"""`mimoc schema`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.printable import printable

EXAMPLE = "Example:  mimoc schema -o infant.schema.json"


def schema(
    of: Annotated[str, typer.Argument(metavar="FILES", help="infant (specs) or cohort (cohort files).")] = "infant",
    out: Annotated[
        Path | None, typer.Option("-o", "--out", metavar="FILE", help="File to write; default: standard output.")
    ] = None,
) -> None:
    """Print the JSON Schema of specs, by which editors complete keys and underline mistakes."""
    from mimoc.bundle.files import write_file
    from mimoc.schema.json_schema import json_schema, json_text

    text = json_text(json_schema(of))
    if out is None:
        print(text, end="")
    else:
        print(printable(write_file(out, text.encode())))

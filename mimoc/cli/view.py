"""`mimoc view`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.infants import load_infant
from mimoc.errors import OutputError

EXAMPLE = "Example:  mimoc view configs/nine_months.yaml -o infant.html"

SUFFIXES = (".html", ".htm")
"""What the name of a page ends in."""


def view(
    shown: Annotated[
        Path,
        typer.Argument(
            metavar="INFANT|RECORDING",
            help="Bundle, spec (.yaml, or `-` for standard input) or recording to show.",
        ),
    ],
    file: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="Page to write: .html.")],
    open_page: Annotated[bool, typer.Option("--open", help="Open it in the browser.")] = False,
) -> None:
    """Write a page that shows the infant in 3D in any browser: one file, which needs no server and no network.

    On the page of a spec or bundle the infant grows from 0 to 24 months, takes poses and can be moved by its joints.
    """
    from mimoc.bundle.files import write_file
    from mimoc.cli import console
    from mimoc.viewer.page import page_of

    if file.suffix.lower() not in SUFFIXES:
        raise OutputError(f"{file}: no page is written to a file of this name; end it in {' or '.join(SUFFIXES)}")
    infant = load_infant(shown)
    with console.status("growing"):
        page = page_of(infant)
    print(write_file(file, page.encode()))
    if open_page:
        typer.launch(str(file.resolve()))

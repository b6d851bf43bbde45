"""`mimoc measure`."""

import csv
from pathlib import Path
from typing import Annotated, Any

import typer

from mimoc.base.errors import MimocError, counted
from mimoc.cli.terminal import printable

Source = Annotated[
    Path | None,
    typer.Argument(metavar="RECORDING", help="Folder written with --record; or one of several, such as a cohort's."),
]
Names = Annotated[list[str] | None, typer.Argument(metavar="NAME", help="Quantities; by default all that there are.")]


def measure(
    recording: Source = None,
    names: Names = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", metavar="FILE.csv", help="Write a row for each episode.")
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="List all quantities, with unit and definition.")] = False,
) -> None:
    """Measure recorded episodes: paths, speeds and movement units of hands and feet, contacts, returns and others."""
    from mimoc.cli import console, tables
    from mimoc.recording.measures import measurable, measure_recordings

    if list_ and (recording or out):
        raise MimocError("--list says what can be measured, of no recording; leave out the rest")
    if list_:
        tables.print_quantities(measurable().values())
        return
    if recording is None:
        raise MimocError("name the folder of a recording, or list what can be measured with --list")
    with console.progress("measuring") as show:
        table = measure_recordings(recording, names or (), progress=show)
    if out:
        _write(out, table)
        print(printable(out))
        return
    quantities = {name: values for name, values in table.items() if name in measurable()}
    tables.print_measured(quantities, counted(len(table["episode"]), "episode"))


def _write(path: Path, table: dict[str, list[Any]]) -> None:
    """Write a table as CSV, whole or not at all; None is an empty cell."""
    import io

    from mimoc.bundle.files import write_file

    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([table, *zip(*table.values(), strict=True)])
    write_file(path, text.getvalue().encode())

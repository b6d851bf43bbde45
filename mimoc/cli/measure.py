"""`mimoc measure`."""

import csv
import sys
from collections.abc import Container
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
    contacts: Annotated[
        Path | None,
        typer.Option(metavar="FILE.csv", help="Write who touches and looks at whom in a world of several infants."),
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="List all quantities, with unit and definition.")] = False,
) -> None:
    """Measure recorded episodes: paths, speeds and movement units of hands and feet, contacts, returns and others.

    Infants that share a world are beside each other, and a second table says who touches and looks at whom.
    """
    from mimoc.cli import console, tables
    from mimoc.recording.between import contacts_and_gaze
    from mimoc.recording.measures import measurable, measure_recordings

    if list_ and (recording or out or contacts):
        raise MimocError("--list says what can be measured, of no recording; leave out the rest")
    if list_:
        tables.print_quantities(measurable().values())
        return
    if recording is None:
        raise MimocError("name the folder of a recording, or list what can be measured with --list")
    with console.progress("measuring") as show:
        table = measure_recordings(recording, names or (), progress=show)
        shares_a_world = contacts or (not names and _is_of_a_world(recording))
        between = contacts_and_gaze(recording, progress=show) if shares_a_world else None
    if out:
        _write(out, table)
    if contacts and between:
        _write(contacts, between)
    if out or contacts:
        sys.stdout.writelines(f"{printable(path)}\n" for path in (out, contacts) if path)
        return
    episodes = counted(len(table["episode"]), "episode")
    tables.print_measured(_by_infant(table, measurable(), together=between is None), episodes)
    if between:
        tables.print_contacts(between, f"contacts and gaze, {episodes}")


def _is_of_a_world(folder: Path) -> bool:
    """Return whether a folder is that of a recording of one world with several infants."""
    from mimoc.recording.description import RECORDING, description_in

    folder = folder.expanduser()
    if not (folder / RECORDING).is_file():
        return False
    description = description_in(folder)
    return 1 < len(description.infants) == len(description.sharing(0))


def _by_infant(table: dict[str, list[Any]], known: Container[str], *, together: bool) -> dict[str, dict[str, Any]]:
    """Return the quantities in a table by the name of the infant, or of all infants together."""
    whose = ["" if together else name for name in table["name"]]
    return {
        who: {
            name: [value for value, owner in zip(values, whose, strict=True) if owner == who]
            for name, values in table.items()
            if name in known
        }
        for who in dict.fromkeys(whose)
    }


def _write(path: Path, table: dict[str, list[Any]]) -> None:
    """Write a table as CSV, whole or not at all; None is an empty cell."""
    import io

    from mimoc.bundle.files import write_file

    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([table, *zip(*table.values(), strict=True)])
    write_file(path, text.getvalue().encode())

"""`mimoc export`."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.arguments import RecordingPath
from mimoc.cli.printable import printable

FORMATS = "minari (needs `mimoc[minari]`), lerobot or csv; or recording, to convert one that an older mimoc made."
EXAMPLE = "Example:  mimoc export recordings/random --to csv -o out/random_csv"


def export(
    recording: RecordingPath,
    to: Annotated[str, typer.Option("--to", metavar="FORMAT", help=FORMATS)],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="OUT", help="Folder to write: a new or empty one.")],
) -> None:
    """Write a recording in the format of others, and say what that cannot hold."""
    from mimoc.cli import console
    from mimoc.recording.export import export_recording

    with console.progress("exporting") as show:
        notes = export_recording(recording, to, out, progress=show)
    for note in notes:
        print(printable(f"note: {note}"), file=sys.stderr)
    print(printable(out))

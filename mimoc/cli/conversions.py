"""`mimoc import` and `mimoc schema`: files for other programs and from them."""

import sys
from pathlib import Path
from typing import Annotated

import typer

from mimoc.base.errors import OutputError
from mimoc.cli.terminal import printable

STDOUT = Path("-")


def import_config(
    system: Annotated[str, typer.Argument(metavar="FORMAT", help="Format of the configuration: babybench.")],
    config: Annotated[Path, typer.Argument(metavar="CONFIG", help="Configuration to convert, a YAML file.")],
    file: Annotated[
        Path, typer.Option("-o", "--out", metavar="FILE.yaml", help="Spec to write, or `-` for standard output.")
    ],
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Convert another system's configuration into a spec, and list the settings that have no counterpart."""
    from mimoc import importers
    from mimoc.bundle import files

    imported = importers.import_config(system, config)
    if file == STDOUT:
        print(*imported.notes, sep="\n", end="\n" if imported.notes else "", file=sys.stderr)
        print(imported.text, end="")
        return
    if file.resolve() == config.resolve():
        raise OutputError(f"{file}: this is the configuration itself; choose another file")
    if file.exists() and not force:
        raise OutputError(f"{file}: already exists; choose another file, or replace it with --force")
    written = files.write_file(file, imported.text.encode())
    for note in imported.notes:
        print(printable(note))
    print(f"{printable(written)}: try it with: mimoc build {printable(written)} -o out/{imported.spec['name']}")


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

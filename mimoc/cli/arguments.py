"""Arguments shared by several commands."""

from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

SpecPath = Annotated[
    Path, typer.Argument(metavar="SPEC", help="YAML file that describes the infant, or `-` for standard input.")
]
InfantPath = Annotated[
    Path,
    typer.Argument(
        metavar="INFANT",
        help="Bundle folder written by `mimoc build`, or a spec (.yaml, or `-` for standard input) to build in memory.",
    ),
]
RecordingPath = Annotated[
    Path, typer.Argument(metavar="RECORDING", help="Folder written by `mimoc run` or `mimoc train` with `--record`.")
]


class Body(StrEnum):
    """What is drawn of infants."""

    SKIN = "skin"
    SOLIDS = "solids"


ShownBody = Annotated[
    Body, typer.Option("--body", help="Draw the skin of infants that have one, or the solids under it.")
]
PicturePath = Annotated[
    Path, typer.Option("-o", "--out", metavar="FILE", help="Image file to write: .png, .jpg, .webp, .bmp or .tiff.")
]

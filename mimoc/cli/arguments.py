"""Arguments shared by several commands."""

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
PicturePath = Annotated[
    Path, typer.Option("-o", "--out", metavar="FILE", help="Image file to write: .png, .jpg, .webp, .bmp or .tiff.")
]

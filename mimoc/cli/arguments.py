"""Arguments that several commands take."""

from pathlib import Path
from typing import Annotated

import typer

SpecPath = Annotated[
    Path, typer.Argument(metavar="SPEC", help="YAML file that describes the infant; `-` reads it from a pipe.")
]
InfantPath = Annotated[
    Path,
    typer.Argument(
        metavar="INFANT",
        help="Folder of a bundle that `mimoc build` wrote, or a spec (.yaml), built in memory; `-` is one from a pipe.",
    ),
]
PicturePath = Annotated[
    Path, typer.Option("-o", "--out", metavar="FILE", help="Picture to write: .png, .jpg, .webp, .bmp or .tiff.")
]

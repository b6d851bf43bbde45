"""Arguments that several commands take."""

from pathlib import Path
from typing import Annotated

import typer

SpecPath = Annotated[Path, typer.Argument(metavar="SPEC", help="YAML file that describes the infant.")]
BundlePath = Annotated[Path, typer.Argument(metavar="OUT", help="Folder of a bundle that `mimoc build` wrote.")]

"""`mimoc render`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.errors import UnknownNameError

EXAMPLE = "Example:  mimoc render out/nine_months -o nine_months.png --pose supine"


def render(
    outs: Annotated[list[Path], typer.Argument(metavar="OUT...", help="Bundles; several stand in a row, to scale.")],
    file: Annotated[Path, typer.Option("-o", "--out", metavar="FILE.png", help="Picture to write.")],
    pose: Annotated[str | None, typer.Option("--pose", help="supine, prone, sitting or standing; the spec's.")] = None,
    width: Annotated[int, typer.Option("--width", min=16, max=4096, help="In pixels.")] = 960,
    height: Annotated[int, typer.Option("--height", min=16, max=4096, help="In pixels.")] = 720,
    skin: Annotated[bool, typer.Option("--skin", help="Show its skin points, and what they feel.")] = False,
) -> None:
    """Draw a picture of the infant, or of several in a row."""
    from mimoc import bundle, files
    from mimoc.runtime.portrait import lineup, portrait
    from mimoc.scene.drawing import encode_png

    if len(outs) > 1 and pose not in (None, "standing"):
        raise UnknownNameError("pose for several infants", str(pose), ["standing"])
    infants = [bundle.read_bundle(out) for out in outs]
    if len(infants) > 1:
        picture = lineup(infants, width, height, skin=skin)
    else:
        picture = portrait(infants[0], pose, width, height, skin=skin)
    print(files.write_file(file, encode_png(picture)))

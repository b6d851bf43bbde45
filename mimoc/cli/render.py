"""`mimoc render`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.arguments import Body, PicturePath
from mimoc.cli.infants import load_infant
from mimoc.cli.printable import printable
from mimoc.errors import UnknownNameError

EXAMPLE = "Example:  mimoc render out/nine_months -o nine_months.png --pose supine"


def render(
    infants: Annotated[
        list[Path],
        typer.Argument(
            metavar="INFANT...",
            help="Bundles or specs (.yaml, or `-` for standard input); several are drawn in a row, to scale.",
        ),
    ],
    file: PicturePath,
    pose: Annotated[
        str | None, typer.Option("--pose", help="supine, prone, sitting or standing; default: the spec's.")
    ] = None,
    width: Annotated[int, typer.Option("--width", min=16, max=4096, help="Width in pixels.")] = 960,
    height: Annotated[int, typer.Option("--height", min=16, max=4096, help="Height in pixels.")] = 720,
    skin: Annotated[bool, typer.Option("--skin", help="Show the skin points and the forces on them.")] = False,
    body: Annotated[
        Body | None, typer.Option("--body", help="Draw the skin or the solids under it; default: skin, without --skin.")
    ] = None,
) -> None:
    """Render an image of the infant, or of several side by side."""
    from mimoc.bundle.model import load_posed, load_straight
    from mimoc.render.picture_files import check_picture_name, write_picture
    from mimoc.render.portrait import lineup, portrait
    from mimoc.senses.touch.preview import skin_markers

    check_picture_name(file)
    if len(infants) > 1 and pose not in (None, "standing"):
        raise UnknownNameError("pose for several infants", str(pose), ["standing"])
    bundles = [load_infant(infant) for infant in infants]
    shown = (body or (Body.SOLIDS if skin else Body.SKIN)).value
    if len(bundles) > 1:
        markers = [skin_markers(bundle, *load_straight(bundle)) for bundle in bundles] if skin else None
        picture = lineup(bundles, width, height, markers, shown)
    else:
        (bundle,) = bundles
        markers = skin_markers(bundle, *load_posed(bundle, pose)) if skin else None
        picture = portrait(bundle, pose, width, height, markers, shown)
    print(printable(write_picture(file, picture)))

"""`mimoc render`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.arguments import PicturePath
from mimoc.cli.infants import take_bundle
from mimoc.errors import UnknownNameError

EXAMPLE = "Example:  mimoc render out/nine_months -o nine_months.png --pose supine"


def render(
    infants: Annotated[
        list[Path],
        typer.Argument(
            metavar="INFANT...",
            help="Bundles or specs (.yaml, or `-` for one from a pipe); several stand in a row, to scale.",
        ),
    ],
    file: PicturePath,
    pose: Annotated[str | None, typer.Option("--pose", help="supine, prone, sitting or standing; the spec's.")] = None,
    width: Annotated[int, typer.Option("--width", min=16, max=4096, help="In pixels.")] = 960,
    height: Annotated[int, typer.Option("--height", min=16, max=4096, help="In pixels.")] = 720,
    skin: Annotated[bool, typer.Option("--skin", help="Show its skin points, and what they feel.")] = False,
) -> None:
    """Draw a picture of the infant, or of several in a row."""
    from mimoc.bundle.model import load_posed, load_straight
    from mimoc.render.picture_files import check_picture_name, write_picture
    from mimoc.render.portrait import lineup, portrait
    from mimoc.senses.touch.preview import skin_markers

    check_picture_name(file)
    if len(infants) > 1 and pose not in (None, "standing"):
        raise UnknownNameError("pose for several infants", str(pose), ["standing"])
    bundles = [take_bundle(infant) for infant in infants]
    if len(bundles) > 1:
        markers = [skin_markers(bundle, *load_straight(bundle)) for bundle in bundles] if skin else None
        picture = lineup(bundles, width, height, markers)
    else:
        (bundle,) = bundles
        markers = skin_markers(bundle, *load_posed(bundle, pose)) if skin else None
        picture = portrait(bundle, pose, width, height, markers)
    print(write_picture(file, picture))

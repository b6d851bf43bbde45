"""`mimoc render`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.arguments import Body, PicturePath
from mimoc.cli.infants import load_infant
from mimoc.cli.printable import printable

EXAMPLE = "Example:  mimoc render out/nine_months -o nine_months.png --pose supine --azimuth 30 --scale-bar"
Azimuth = Annotated[
    float | None,
    typer.Option(
        "--azimuth",
        min=-360,
        max=360,
        help="Where the camera stands around the infants, in degrees: 0 in front of them, 90 at their left, 180 behind "
        "them; default: a little to the right of one infant, in front of several.",
    ),
]
Elevation = Annotated[
    float | None,
    typer.Option(
        "--elevation",
        min=-90,
        max=90,
        help="How high it stands, in degrees: 0 level with them, 90 straight above; default: what suits the pose.",
    ),
]
Distance = Annotated[
    float | None,
    typer.Option(
        "--distance",
        min=0.1,
        max=100,
        help="How far it stands from the middle of them, in metres; default: so that they fill the image.",
    ),
]
Transparent = Annotated[
    bool,
    typer.Option("--transparent", help="Draw the infants alone, on a transparent background (.png, .webp or .tiff)."),
]
ScaleBar = Annotated[
    bool,
    typer.Option("--scale-bar", help="Draw a bar of so many cm, true at the distance of the middle of the infants."),
]


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
        str | None,
        typer.Option("--pose", help="supine, prone, sitting or standing, of all; default: each one's spec's."),
    ] = None,
    width: Annotated[int, typer.Option("--width", min=16, max=4096, help="Width in pixels.")] = 960,
    height: Annotated[int, typer.Option("--height", min=16, max=4096, help="Height in pixels.")] = 720,
    skin: Annotated[bool, typer.Option("--skin", help="Show the skin points and the forces on them.")] = False,
    body: Annotated[
        Body | None, typer.Option("--body", help="Draw the skin or the solids under it; default: skin, without --skin.")
    ] = None,
    azimuth: Azimuth = None,
    elevation: Elevation = None,
    distance: Distance = None,
    transparent: Transparent = False,
    scale_bar: ScaleBar = False,
) -> None:
    """Render an image of the infant, or of several side by side."""
    from mimoc.bundle.model import load_posed
    from mimoc.render.picture_files import check_picture_name, write_picture
    from mimoc.render.portrait import Framing, lineup, portrait
    from mimoc.senses.touch.preview import skin_markers

    check_picture_name(file, transparent=transparent)
    framing = Framing(azimuth, elevation, distance, transparent, scale_bar)
    bundles = [load_infant(infant) for infant in infants]
    shown = (body or (Body.SOLIDS if skin else Body.SKIN)).value
    markers = [skin_markers(bundle, *load_posed(bundle, pose)) for bundle in bundles] if skin else None
    if len(bundles) > 1:
        picture = lineup(bundles, pose, width, height, markers, shown, framing)
    else:
        picture = portrait(bundles[0], pose, width, height, markers[0] if markers else None, shown, framing)
    print(printable(write_picture(file, picture)))

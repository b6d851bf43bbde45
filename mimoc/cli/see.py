"""`mimoc see`."""

from typing import Annotated

import typer

from mimoc.cli.arguments import InfantPath, PicturePath
from mimoc.cli.infants import resolved_spec, take_bundle

EXAMPLE = "Example:  mimoc see out/nine_months -o seen.png --pose sitting --ages 1,3,9"


def see(
    infant: InfantPath,
    file: PicturePath,
    ages: Annotated[str, typer.Option("--ages", metavar="MONTHS,...", help="Whose acuity: 0 to 36.")] = "1,2,4,6,12",
    profile: Annotated[
        str | None, typer.Option("--profile", help="Acuity by age: tac2, mayer1995 or mimo_v2; the spec's.")
    ] = None,
    foveation: Annotated[
        float | None, typer.Option("--foveation", min=0, max=1000, help="Its strength; the spec's, or 5 if that is 0.")
    ] = None,
    pose: Annotated[str | None, typer.Option("--pose", help="supine, prone, sitting or standing; the spec's.")] = None,
    eye: Annotated[str, typer.Option("--eye", help="left or right.")] = "left",
    down: Annotated[
        float | None,
        typer.Option("--down", min=-90, max=90, help="How far the eye looks down, degrees; at a toy, or at a hand."),
    ] = None,
    fovy: Annotated[
        float, typer.Option("--fovy", min=1, max=170, help="Field of view, degrees: acuity shows if it is narrow.")
    ] = 18,
    size: Annotated[int, typer.Option("--size", min=16, max=1024, help="Of each picture, pixels.")] = 256,
) -> None:
    """Draw what the infant looks at: as fine as several ages see it, foveated as well, and as it is drawn."""
    from mimoc import schema
    from mimoc.render.picture_files import check_picture_name, write_picture
    from mimoc.render.picture_grid import tile_pictures
    from mimoc.senses.vision.comparison import compare_ages, read_ages
    from mimoc.senses.vision.preview import glimpse

    check_picture_name(file)
    built = take_bundle(infant)
    vision = resolved_spec(built).senses.vision or schema.VisionSpec()
    compared = compare_ages(vision, eye, read_ages(ages), size, profile=profile, foveation=foveation)
    pictures = glimpse(built, compared.sights, pose, down, fovy)
    print(write_picture(file, tile_pictures(pictures, compared.columns, compared.rows)))

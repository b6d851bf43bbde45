"""`mimoc see`."""

from typing import Annotated, Any

import typer

from mimoc.cli.arguments import InfantPath, PicturePath
from mimoc.cli.infants import load_infant, resolved_spec
from mimoc.cli.printable import printable

EXAMPLE = "Example:  mimoc see out/nine_months -o seen.png --pose sitting --ages 1,3,9"
Pose = Annotated[str | None, typer.Option("--pose", help="supine, prone, sitting or standing; default: the spec's.")]
NOTHING_SEEN = (
    "note: the eye sees one plain surface (sky, floor, or skin near by), so all views are alike; let it see something: "
    "another --pose (sitting), --down, a wider --fovy, or a room with toys (`scene: {kind: room}`)"
)


def see(
    infant: InfantPath,
    file: PicturePath,
    ages: Annotated[
        str, typer.Option("--ages", metavar="MONTHS,...", help="Ages in months, 0 to 36, whose acuity is shown.")
    ] = "1,2,4,6,12",
    profile: Annotated[
        str | None,
        typer.Option("--profile", help="Acuity by age: tac2, mayer1995 or mimo_v2; default: the spec's."),
    ] = None,
    foveation: Annotated[
        float | None,
        typer.Option("--foveation", min=0, max=1000, help="Strength of foveation; default: the spec's, or 5 if 0."),
    ] = None,
    pose: Pose = None,
    eye: Annotated[str, typer.Option("--eye", help="left or right.")] = "left",
    down: Annotated[
        float | None,
        typer.Option("--down", min=-90, max=90, help="Downward gaze in degrees; default: towards a toy or a hand."),
    ] = None,
    fovy: Annotated[
        float,
        typer.Option("--fovy", min=1, max=170, help="Vertical field of view in degrees; acuity shows best if narrow."),
    ] = 18,
    size: Annotated[int, typer.Option("--size", min=16, max=1024, help="Size of each view in pixels.")] = 256,
) -> None:
    """Render what the infant sees at several ages, with and without foveation, beside the unblurred view."""
    from mimoc import schema
    from mimoc.render.picture_files import check_picture_name, write_picture
    from mimoc.render.picture_grid import tile_pictures
    from mimoc.senses.vision.comparison import compare_ages, read_ages
    from mimoc.senses.vision.preview import preview

    check_picture_name(file)
    bundle = load_infant(infant)
    vision = resolved_spec(bundle).senses.vision or schema.VisionSpec()
    compared = compare_ages(vision, eye, read_ages(ages), size, profile=profile, foveation=foveation)
    pictures = preview(bundle, compared.entries, pose, down, fovy)
    print(printable(write_picture(file, tile_pictures(pictures, compared.columns, compared.rows))))
    _say_if_blank(pictures[0][-1])


def _say_if_blank(unblurred: Any) -> None:
    from mimoc.senses.vision.preview import is_blank

    if is_blank(unblurred):
        print(NOTHING_SEEN)

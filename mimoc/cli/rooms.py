"""`mimoc rooms`."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mimoc.cli.arguments import PicturePath
from mimoc.cli.infants import load_spec_of_infant
from mimoc.cli.printable import printable
from mimoc.errors import MimocError, SpecError

if TYPE_CHECKING:
    from mimoc.schema.infant import InfantSpec

MAX_ROOMS = 400
"""Largest number of scenes in one image."""

EXAMPLE = "Example:  mimoc rooms playroom.yaml --seeds 0:12 -o rooms.png"


def rooms(
    spec: Annotated[
        Path,
        typer.Argument(
            metavar="SPEC", help="Spec with a room or toys (.yaml, or `-` for standard input), or a bundle."
        ),
    ],
    file: PicturePath,
    seeds: Annotated[
        str, typer.Option("--seeds", metavar="FIRST:END", help="Seeds of the scenes; END is excluded.")
    ] = "0:12",
    size: Annotated[int, typer.Option("--size", min=32, max=1024, help="Width of each scene's image in pixels.")] = 320,
) -> None:
    """Render the scenes of several seeds in one image."""
    from mimoc.cli import console
    from mimoc.compiler import building
    from mimoc.render.overview import overview
    from mimoc.render.picture_files import check_picture_name, write_picture
    from mimoc.render.picture_grid import captioned_grid

    check_picture_name(file)
    wanted, infant, pictures = parse_seeds(seeds), load_spec_of_infant(spec), []
    _check_seed_matters(infant)
    builder = building.builder(infant)
    with console.progress("drawing") as show:
        for number, seed in enumerate(wanted, start=1):
            pictures.append(overview(builder(seed, check=False), size, size * 3 // 4))
            show(number, len(wanted))
    print(printable(write_picture(file, captioned_grid(pictures, [f"seed {seed}" for seed in wanted]))))


def _check_seed_matters(spec: "InfantSpec") -> None:
    """Print a note if only the toys depend on the seed.

    Raises:
        SpecError: If nothing in the scene depends on the seed.
    """
    from mimoc.scenes import SCENES
    from mimoc.schema.infant import as_written

    kind = spec.scene.kind
    if SCENES[kind].varies:
        return
    if spec.scene.toys is None:
        others = " or ".join(f"'kind: {each.name}'" for each in SCENES.values() if each.varies)
        message = f"'{kind}' without toys is the same for every seed; write {others}, or add toys"
        raise SpecError([as_written(spec).problem(("scene", "kind"), message)])
    print(f"note: in a '{kind}' scene only the toys depend on the seed", file=sys.stderr)


def parse_seeds(text: str) -> range:
    """Return the seeds given by a text such as `0:12` (the end is excluded) or `7`.

    Raises:
        MimocError: If the text is not a range of seeds, or the range is empty or too large.
    """
    first, colon, end = text.partition(":")
    if not (first.isdecimal() and (end if colon else first).isdecimal()):
        raise MimocError(f"'{text}' is not a range of seeds; write FIRST:END, such as 0:12")
    found = range(int(first), int(end) if colon else int(first) + 1)
    if not 0 < len(found) <= MAX_ROOMS:
        raise MimocError(f"'{text}' is a range of {len(found)} seeds; give 1 to {MAX_ROOMS}")
    return found

"""`mimoc rooms`."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mimoc.cli.arguments import PicturePath
from mimoc.cli.infants import take_bundles_spec
from mimoc.errors import MimocError, SpecError

if TYPE_CHECKING:
    from mimoc.schema.infant import InfantSpec

MOST_ROOMS = 400
"""On one sheet."""

EXAMPLE = "Example:  mimoc rooms configs/playroom.yaml --seeds 0:12 -o rooms.png"


def rooms(
    spec: Annotated[
        Path,
        typer.Argument(metavar="SPEC", help="YAML file with a room or toys, `-` for one from a pipe, or a bundle."),
    ],
    file: PicturePath,
    seeds: Annotated[str, typer.Option("--seeds", metavar="FIRST:END", help="Seeds of the scenes.")] = "0:12",
    size: Annotated[int, typer.Option("--size", min=32, max=1024, help="Width of each picture, pixels.")] = 320,
) -> None:
    """Draw the scenes that several seeds give, on one sheet."""
    from mimoc.cli import console
    from mimoc.compiler import pipeline
    from mimoc.render.overview import overview
    from mimoc.render.picture_files import check_picture_name, write_picture
    from mimoc.render.picture_grid import captioned_grid

    check_picture_name(file)
    wanted, infant, pictures = read_range(seeds), take_bundles_spec(spec), []
    _say_what_differs(infant)
    builder = pipeline.builder(infant)
    with console.progress("drawing") as show:
        for number, seed in enumerate(wanted, start=1):
            pictures.append(overview(builder(seed, check=False), size, size * 3 // 4))
            show(number, len(wanted))
    print(write_picture(file, captioned_grid(pictures, [f"seed {seed}" for seed in wanted])))


def _say_what_differs(spec: "InfantSpec") -> None:
    """Say so where there is no room to draw, and refuse a scene in which a seed changes nothing.

    Raises:
        SpecError: If all pictures would be the same.
    """
    from mimoc.schema.infant import as_written

    kind = spec.scene.kind
    if kind == "room":
        return
    if spec.scene.toys is None:
        message = f"'{kind}' without toys is the same for every seed; write 'kind: room', or add toys"
        raise SpecError([as_written(spec).problem(("scene", "kind"), message)])
    print(f"note: the scene is '{kind}', not a room: only its toys differ from seed to seed", file=sys.stderr)


def read_range(text: str) -> range:
    """Return the seeds that a text such as `0:12` names: the first, and the first that is not.

    Raises:
        MimocError: If it names none.
    """
    first, colon, end = text.partition(":")
    if not (first.isdecimal() and (end if colon else first).isdecimal()):
        raise MimocError(f"'{text}' names no seeds; write the first and the end, such as 0:12")
    found = range(int(first), int(end) if colon else int(first) + 1)
    if not 0 < len(found) <= MOST_ROOMS:
        raise MimocError(f"'{text}' names {len(found)} seeds; give 1 to {MOST_ROOMS}")
    return found

"""`mimoc rooms`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.cli.arguments import SpecPath
from mimoc.errors import MimocError

MOST_ROOMS = 400
"""On one sheet."""

EXAMPLE = "Example:  mimoc rooms configs/playroom.yaml --seeds 0:12 -o rooms.png"


def rooms(
    spec: SpecPath,
    file: Annotated[Path, typer.Option("-o", "--out", metavar="FILE.png", help="Picture to write.")],
    seeds: Annotated[str, typer.Option("--seeds", metavar="FIRST:END", help="Seeds of the scenes.")] = "0:12",
    size: Annotated[int, typer.Option("--size", min=32, max=1024, help="Width of each picture, pixels.")] = 320,
) -> None:
    """Draw the scenes that several seeds give, on one sheet."""
    from mimoc import console, files, pipeline
    from mimoc.runtime.overview import overview
    from mimoc.scene.drawing import encode_png
    from mimoc.scene.sheet import draw_grid

    wanted, builder, pictures = read_range(seeds), pipeline.builder(pipeline.load_spec(spec)), []
    with console.progress("drawing") as show:
        for number, seed in enumerate(wanted, start=1):
            pictures.append(overview(builder(seed, check=False), size, size * 3 // 4))
            show(number, len(wanted))
    print(files.write_file(file, encode_png(draw_grid(pictures, [f"seed {seed}" for seed in wanted]))))


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

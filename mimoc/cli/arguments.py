"""Arguments that several commands share, and what is loaded of them: specs, bundles, classes of a user."""

import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mimoc.base.classes import import_class
from mimoc.base.errors import BundleError, MimocError

if TYPE_CHECKING:
    from mimoc.bundle.io import Bundle
    from mimoc.bundle.world import WorldBundle
    from mimoc.policies.policy import PolicyMaker
    from mimoc.schema.infant import InfantSpec

SpecPath = Annotated[
    Path, typer.Argument(metavar="SPEC", help="YAML file that describes the infant, or `-` for standard input.")
]
InfantPath = Annotated[
    Path,
    typer.Argument(
        metavar="INFANT",
        help="Bundle folder written by `mimoc build`, one written by `mimoc retarget`, or a spec (.yaml, or `-` for "
        "standard input) to build in memory.",
    ),
]
RecordingPath = Annotated[
    Path,
    typer.Argument(
        metavar="RECORDING", help="Folder written by `mimoc retarget`, or by `mimoc run` or `train` with `--record`."
    ),
]


class Body(StrEnum):
    """What is drawn of infants."""

    SKIN = "skin"
    SOLIDS = "solids"


ShownBody = Annotated[Body, typer.Option(help="Draw the skin of infants that have one, or the solids under it.")]
PicturePath = Annotated[
    Path, typer.Option("-o", "--out", metavar="FILE", help="Image file to write: .png, .jpg, .webp, .bmp or .tiff.")
]
STDIN = Path("-")
Beside = Annotated[
    str | None,
    typer.Option(metavar="healthy", help="Put the same child without what impairs it beside the one of the spec."),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print the numbers as JSON.")]
Eyes = Annotated[bool, typer.Option("--eyes", help="Show the views of both eyes beside the video.")]
VideoHeight = Annotated[int, typer.Option(min=64, max=2160, help="Height of the video in pixels.")]
Force = Annotated[bool, typer.Option("--force", help="Replace an existing file.")]


def load_spec(path: Path) -> "InfantSpec":
    """Return the spec in a file or, for `-`, in standard input, where paths are relative to the working directory."""
    from mimoc import schema
    from mimoc.schema import source
    from mimoc.schema.infant import load_spec

    if path != STDIN:
        return load_spec(path)
    if sys.stdin.isatty():
        print("reading a spec from the terminal; end it with Ctrl-D", file=sys.stderr)
    return schema.read_spec(source.read_stream(sys.stdin.buffer, "<stdin>"))


def load_infant(path: Path) -> "Bundle":
    """Return the bundle in a folder, or of a recording, or built from a spec: of a file or, for `-`, standard input."""
    from mimoc.cli import console
    from mimoc.compiler import building
    from mimoc.recording.folder import read_infant
    from mimoc.schema.infant import SPEC_SUFFIXES

    if path.is_file() and path.suffix.lower() not in SPEC_SUFFIXES:
        raise BundleError(f"{path}: this is a file; name the folder of a bundle, or a spec that ends in .yaml or .yml")
    if path.is_dir() or (path != STDIN and path.suffix.lower() not in SPEC_SUFFIXES):
        return read_infant(path)
    spec = load_spec(path)
    with console.progress("building") as show:
        return building.build(spec, progress=show)


def find_world(path: Path, scene_seed: int | None = None, **refused: object) -> "WorldBundle | None":
    """Return the world of several infants in a folder, or built from a file; None if there is something else.

    The options *refused* are for single infants, by name, as they were given.
    """
    from mimoc.compiler.worlds import world_of

    world = world_of(path, scene_seed)
    for name, given in refused.items() if world else ():
        if given is not None and given is not False:
            raise MimocError(f"--{name} is for a single infant, and this is a world with several; leave it out")
    return world


def load_counterpart(path: Path, beside: str) -> "InfantSpec":
    """Return the child that stands beside the one of a spec or of a bundle, such as the `healthy` one."""
    from mimoc.compiler.provenance import SPEC_FILE
    from mimoc.schema.counterparts import counterpart

    file = path / SPEC_FILE if path.is_dir() else path
    if path == STDIN or not file.is_file():
        raise MimocError(f"{path}: --beside changes the spec of an infant; name the file of one, or a bundle")
    return counterpart(load_spec(file), beside)


def load_trained(path: str) -> "PolicyMaker":
    """Return the trained policy in a file; PyTorch is only imported when there is one."""
    from mimoc.training.evaluation import load_policy

    return load_policy(path)


def check_video(video: Path | None, eyes: bool) -> None:
    """Raise a MimocError if a video cannot be made, or there is none to show eyes in."""
    from mimoc.recording import video as videos

    if eyes and not video:
        raise MimocError("--eyes adds the eyes' views to a video; give its file with --video FILE")
    if video:
        videos.check_video(video)


def import_object(name: str) -> Any:
    """Return an instance of a class that is named as `module:Class`; the module can be in the current folder."""
    made = import_class(name, "my_task:Stillness")
    try:
        return made()
    except TypeError as error:
        raise MimocError(f"'{name}': {error}; give all its arguments defaults") from None

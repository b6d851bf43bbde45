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


def load_spec(path: Path) -> "InfantSpec":
    """Return the spec in a file or, for `-`, in standard input, where paths are relative to the working directory.

    Raises:
        SpecError: If the spec is invalid.
    """
    from mimoc import schema
    from mimoc.compiler import loading
    from mimoc.schema import source

    if path != STDIN:
        return loading.load_spec(path)
    if sys.stdin.isatty():
        print("reading a spec from the terminal; end it with Ctrl-D", file=sys.stderr)
    return schema.read_spec(source.read_stream(sys.stdin.buffer, "<stdin>"))


def load_infant(path: Path) -> "Bundle":
    """Return the bundle in a folder, or of a recording, or built from a spec: of a file or, for `-`, standard input.

    Raises:
        BundleError: If the folder is not an intact bundle.
        RecordingError: If the folder is a recording that is damaged, or of several infants.
        SpecError: If the spec cannot be built.
        ModelError: If MuJoCo rejects the model.
    """
    from mimoc.cli import console
    from mimoc.compiler import loading, pipeline
    from mimoc.recording.folder import read_infant

    if path.is_file() and path.suffix.lower() not in loading.SPEC_SUFFIXES:
        raise BundleError(f"{path}: this is a file; name the folder of a bundle, or a spec that ends in .yaml or .yml")
    if path.is_dir() or (path != STDIN and path.suffix.lower() not in loading.SPEC_SUFFIXES):
        return read_infant(path)
    spec = load_spec(path)
    with console.progress("building") as show:
        return pipeline.build(spec, progress=show)


def load_counterpart(path: Path, beside: str) -> "InfantSpec":
    """Return the child that stands beside the one of a spec or of a bundle, such as the `healthy` one.

    Raises:
        SpecError: If the spec is invalid, or there is no such child.
        UnknownNameError: If there is no such counterpart.
        MimocError: If there is no spec, or nothing impairs its child.
    """
    from mimoc.compiler.provenance import SPEC_FILE
    from mimoc.schema.counterparts import counterpart

    file = path / SPEC_FILE if path.is_dir() else path
    if path == STDIN or not file.is_file():
        raise MimocError(f"{path}: --beside changes the spec of an infant; name the file of one, or a bundle")
    return counterpart(load_spec(file), beside)


def load_trained(path: str) -> "PolicyMaker":
    """Return the trained policy in a file; PyTorch is only imported when there is one."""
    from mimoc.training.loading import load_policy

    return load_policy(path)


def check_video(video: Path | None, eyes: bool) -> None:
    """Raise a MimocError if a video cannot be made, or there is none to show eyes in."""
    from mimoc import recording

    if eyes and not video:
        raise MimocError("--eyes adds the eyes' views to a video; give its file with --video FILE")
    if video:
        recording.check_video(video)


def import_object(name: str) -> Any:
    """Return an instance of a class that is named as `module:Class`; the module can be in the current folder.

    Raises:
        MimocError: If there is no such module or class, or it cannot be made without arguments.
    """
    made = import_class(name, "my_task:Stillness")
    try:
        return made()
    except TypeError as error:
        raise MimocError(f"'{name}': {error}; give all its arguments defaults") from None

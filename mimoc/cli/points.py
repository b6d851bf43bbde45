"""Options of commands that read recorded points, and messages that name them."""

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Annotated

import typer

from mimoc.base.errors import MimocError, RecordingError

Rate = Annotated[
    float | None,
    typer.Option("--rate", metavar="HZ", min=0.1, help="Frames per second of points, if their files lack it."),
]
Infant = Annotated[str | None, typer.Option(metavar="ID", help="Which person is the infant; default: the largest.")]
MinScore = Annotated[
    float | None,
    typer.Option(
        "--min-score",
        metavar="0-1",
        min=0,
        max=1,
        help="Confidence below which points are taken not to be seen; default: what their format's own programs use.",
    ),
]
ViewName = Annotated[
    str,
    typer.Option(
        metavar="VIEW",
        help="What the camera sees: the infant's front; its back, if it lies on its belly; mirrored, if the picture is"
        " or y counts upwards; swapped, if left is right.",
    ),
]
Picture = Annotated[
    str | None,
    typer.Option(metavar="W,H", help="Size of the picture in pixels, if points are shares of it, as MediaPipe's are."),
]
UpAxis = Annotated[
    str | None,
    typer.Option(
        "--up", metavar="AXIS", help="Axis that points upwards, of points in space: x, y, z, -x, -y or -z; default: z."
    ),
]
Names = Annotated[
    list[str] | None,
    typer.Option(
        "--name", metavar="LABEL=POINT", help="Which point a label is, if mimoc does not know it; may be repeated."
    ),
]
_OPTIONS = (
    (r"\brate_hz=(\S+)", r"--rate \1"),
    (r"\bmin_score=(\S+)", r"--min-score \1"),
    (r"\bview='(\w+)'", r"--view \1"),
    (r"\bup='(-?\w)'", r"--up \1"),
    (r"\binfant='([^']*)'", r"--infant \1"),
    (r"\bpicture_px=\((\d+), (\d+)\)", r"--picture \1,\2"),
    (r"\bcamera_pitch_deg=", "--camera-pitch "),
    (r"\bpose='(\w+)'", r"--pose \1"),
    (r"\bnames=\{'label': '(\w+)'\}", r"--name label=\1"),
)
"""Arguments of `read_points` and `retarget` in messages, and the options that stand for them."""


def names_of(texts: Sequence[str] | None) -> dict[str, str] | None:
    """Return the names of points by label in texts such as `p7=left_foot`, or None for none."""
    pairs = [text.rpartition("=") for text in texts or ()]
    for label, _, point in pairs:
        if not label or not point:
            raise MimocError(f"--name: '{label or point}' is no label with its point; write it as p7=left_foot")
    return {label: point for label, _, point in pairs} or None


def picture_of(text: str | None) -> tuple[int, int] | None:
    """Return width and height in a text such as `1920,1080`, or None for none."""
    if text is None:
        return None
    match = re.fullmatch("([1-9][0-9]{0,5})[,x]([1-9][0-9]{0,5})", text.replace(" ", ""))
    if match is None:
        raise MimocError(f"--picture: '{text}' is not the size of a picture; give W,H in pixels, such as 1920,1080")
    return int(match[1]), int(match[2])


@contextmanager
def options_in_messages() -> Iterator[None]:
    """Let errors about recorded points name the options of a command instead of the arguments of `read_points`."""
    try:
        yield
    except RecordingError as error:
        text = str(error)
        for argument, option in _OPTIONS:
            text = re.sub(argument, option, text)
        raise RecordingError(text) from None

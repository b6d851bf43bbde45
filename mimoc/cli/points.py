"""Options of commands that read recorded points, and messages that name them."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

import typer

from mimoc.base.errors import RecordingError

Rate = Annotated[
    float | None,
    typer.Option("--rate", metavar="HZ", min=0.1, help="Frames per second of points, if their files lack it."),
]
Infant = Annotated[str | None, typer.Option(metavar="ID", help="Which person is the infant; default: the largest.")]
ViewName = Annotated[
    str,
    typer.Option(
        metavar="VIEW",
        help="What the camera sees: the infant's front; its back, if it lies on its belly; mirrored, if the picture is"
        " or y counts upwards; swapped, if left is right.",
    ),
]
_OPTIONS = (r"\brate_hz=(\S+)", r"--rate \1"), (r"\bview='(\w+)'", r"--view \1")
"""Arguments of `read_points` in messages, and the options that stand for them."""


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

"""JSON files that may come from anyone, read as data of a type."""

from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from mimoc.bundle.regular_files import UnusableFileError, read_regular_file
from mimoc.schema.base import Model

MOST_BYTES = 2**22
"""Of a file, unless its reader knows better; 4 MB."""
_SHOWN = 3
"""Most problems that an error lists."""

Data = TypeVar("Data", bound=Model)


def read_json_file(
    path: Path, kind: type[Data], most_bytes: int = MOST_BYTES, *, below: Path | None = None
) -> Data | None:
    """Return the content of a JSON file as data of a type; None if it does not exist or cannot be read.

    Args:
        path: The file.
        kind: What it must contain; nothing is converted: text is no number, and a number no text.
        most_bytes: The largest size that is read.
        below: A folder above it; no folder between the two may be a link. By default, the one that it is in.

    Raises:
        UnusableFileError: If it is not a regular file, too large, or contains anything else: one line to write after
            the path and a colon.
    """
    content = read_regular_file(path, most_bytes, below=below)
    return None if content is None else parse_json(content, kind)


def parse_json(content: bytes, kind: type[Data]) -> Data:
    """Return JSON as data of a type; see `read_json_file`.

    Raises:
        UnusableFileError: If it is anything else.
    """
    try:
        return kind.model_validate_json(content, strict=True)
    except ValidationError as error:
        raise UnusableFileError(problems_in(error)) from None


def problems_in(error: ValidationError) -> str:
    """Return what is wrong with the data of a file, key by key, in one line of printable text."""
    problems = [
        ": ".join([".".join(map(str, problem["loc"])), problem["msg"].removeprefix("Value error, ")]).removeprefix(": ")
        for problem in error.errors(include_url=False, include_context=False, include_input=False)
    ]
    more = [f"and {len(problems) - _SHOWN} more"] if len(problems) > _SHOWN else []
    return one_line("; ".join(problems[:_SHOWN] + more))


def one_line(text: str) -> str:
    """Return a text of which some comes from anyone, with question marks in place of characters that do not print."""
    return "".join(character if character.isprintable() else "?" for character in text)

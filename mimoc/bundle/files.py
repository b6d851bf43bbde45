"""Single files, written whole or not at all."""

import os
import secrets
from contextlib import suppress
from pathlib import Path

from mimoc.errors import OutputError


def write_file(path: str | Path, content: bytes) -> Path:
    """Write a file into an existing folder; whoever reads it sees the old content or the new one.

    Raises:
        OutputError: If it cannot be written.
    """
    path = Path(path).expanduser()
    beside = name_beside(path)
    try:
        beside.write_bytes(content)
    except OSError as error:
        discard(beside)
        raise cannot_be_written(path, error) from None
    return put_in_place(beside, path)


def name_beside(path: Path) -> Path:
    """Return a name in the folder of a file for what is to take its place once it is whole."""
    return path.parent / f".mimoc-{secrets.token_hex(8)}.tmp"


def put_in_place(beside: Path, path: Path) -> Path:
    """Give a file that is whole its name, which may be that of an older one.

    Raises:
        OutputError: If that cannot be; the file is gone then.
    """
    try:
        os.replace(beside, path)
    except OSError as error:
        discard(beside)
        raise cannot_be_written(path, error) from None
    return path


def discard(beside: Path) -> None:
    """Remove a file that is not to be, if it is there."""
    with suppress(OSError):
        beside.unlink()


def cannot_be_written(path: Path, error: OSError) -> OutputError:
    """Return the error that tells a user why a file cannot be written."""
    return OutputError(f"{path}: cannot be written ({error.strerror}); choose another place")

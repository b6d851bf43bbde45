"""Atomic writing of single files, and whether a page can be written to one."""

import os
from contextlib import suppress
from pathlib import Path

from mimoc.bundle.leftovers import remove_leftovers, unfinished_name
from mimoc.errors import OutputError

PAGES = (".html", ".htm")
"""What the name of a page ends in."""
_PREFIX, _SUFFIX = ".mimoc-", ".tmp"


def check_page(file: str | Path) -> Path:
    """Check, before anything takes time, that a page can be written to a file; return its path.

    Raises:
        OutputError: If its name does not end as that of a page, or its folder does not exist.
    """
    path = Path(file).expanduser()
    if path.suffix.lower() not in PAGES:
        raise OutputError(f"{path}: not the name of a page; end it in {' or '.join(PAGES)}")
    if not path.parent.is_dir():
        raise OutputError(f"{path}: there is no folder {path.parent}; make it, or choose another place")
    return path


def write_file(path: str | Path, content: bytes) -> Path:
    """Write a file into an existing folder atomically: a reader sees either the old content or the new.

    Raises:
        OutputError: If the file cannot be written.
    """
    path = Path(path).expanduser()
    temporary = temporary_path(path)
    try:
        temporary.write_bytes(content)
    except OSError as error:
        discard(temporary)
        raise write_error(path, error) from None
    return move_into_place(temporary, path)


def temporary_path(path: Path) -> Path:
    """Return the path of a temporary file in the same folder, to be renamed to *path* when it is complete."""
    return path.parent / f"{unfinished_name(_PREFIX)}{_SUFFIX}"


def remove_temporary_files(folder: Path) -> None:
    """Remove the temporary files in a folder that killed processes of this machine have left behind."""
    remove_leftovers(folder, _PREFIX)


def move_into_place(temporary: Path, path: Path) -> Path:
    """Rename a complete temporary file to *path*, replacing any existing file.

    Raises:
        OutputError: If it cannot be renamed; the temporary file is removed then.
    """
    try:
        os.replace(temporary, path)
    except OSError as error:
        discard(temporary)
        raise write_error(path, error) from None
    return path


def discard(temporary: Path) -> None:
    """Remove a temporary file if it exists."""
    with suppress(OSError):
        temporary.unlink()


def write_error(path: Path, error: OSError) -> OutputError:
    """Return the error that says why a file cannot be written."""
    return OutputError(f"{path}: cannot be written ({error.strerror}); choose another place")

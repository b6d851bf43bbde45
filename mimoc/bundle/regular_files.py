"""The regular files in a folder, of a bounded size; nothing is read through links, and no pipe is waited for."""

import errno
import os
import stat
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path, PurePosixPath

MOST_BYTES = 2**26
"""Of one file; 64 MB."""
MOST_BYTES_IN_ALL = 2**27
"""Of all files of a bundle, of which infants with the densest skin have a tenth."""
MOST_FILES = 4096
MOST_NESTED = 8
"""Folders within each other."""

_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
_LINK_MET = (errno.ELOOP, errno.EMLINK, errno.ENOTDIR)
"""Errors of opening a file or, the last, a folder that is a link."""
_FILE = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC


class UnusableFileError(Exception):
    """A file is a link, a pipe or a device, or too large."""


class RegularFiles:
    """Reads files of one folder."""

    def __init__(self, folder: int, handles: ExitStack):
        """Read from a folder that is open, and keep others open until *handles* is closed."""
        self._folders, self._handles = {PurePosixPath("."): folder}, handles
        self._left = MOST_BYTES_IN_ALL

    def read(self, name: str, most_bytes: int = MOST_BYTES) -> bytes | None:
        """Return the content of a file, None if it does not exist or cannot be read.

        Raises:
            UnusableFileError: If it is not a regular file of the folder, or too large.
        """
        path = PurePosixPath(name)
        try:
            content = _read(path.name, min(most_bytes, self._left), self._folder(path.parent))
        except OSError as error:
            if error.errno in _LINK_MET:
                raise UnusableFileError("is a link, which mimoc never writes") from None
            return None
        self._left -= len(content or b"")
        return content

    def _folder(self, path: PurePosixPath) -> int:
        if path not in self._folders:
            above = self._folder(path.parent)
            handle = os.open(path.name, _FOLDER, dir_fd=above)
            self._handles.callback(os.close, handle)
            self._folders[path] = handle
        return self._folders[path]


@contextmanager
def regular_files(folder: Path) -> Iterator[RegularFiles]:
    """Open a folder, which may itself be a link, to read its files.

    Raises:
        OSError: If it cannot be opened.
    """
    with ExitStack() as handles:
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        handles.callback(os.close, handle)
        yield RegularFiles(handle, handles)


def read_regular_file(path: Path, most_bytes: int = MOST_BYTES) -> bytes | None:
    """Return the content of a file, None if it does not exist or cannot be read.

    Raises:
        UnusableFileError: If it is not a regular file, or too large.
    """
    try:
        return _read(path, most_bytes)
    except OSError:
        return None


def is_regular_file(path: Path) -> bool:
    """Return whether there is a file that is neither a link nor a pipe nor a device."""
    try:
        return stat.S_ISREG(os.lstat(path).st_mode)
    except OSError:
        return False


def _read(path: str | Path, most_bytes: int, folder: int | None = None) -> bytes | None:
    handle = os.open(path, _FILE, dir_fd=folder)
    try:
        found = os.fstat(handle)
        if stat.S_ISDIR(found.st_mode):
            return None
        if not stat.S_ISREG(found.st_mode):
            raise UnusableFileError("is not a regular file")
        if found.st_size > most_bytes:
            raise UnusableFileError("is larger than those of any infant")
        return _all(handle, found.st_size)
    finally:
        os.close(handle)


def _all(handle: int, size: int) -> bytes:
    """Return the content of a file of some size, or what is left of it if it was cut meanwhile."""
    parts = [os.read(handle, size)]
    while parts[-1] and sum(map(len, parts)) < size:
        parts.append(os.read(handle, size))
    return parts[0] if len(parts) == 1 else b"".join(parts)

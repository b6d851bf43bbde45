"""Regular files of a bounded size, and JSON in them; nothing is read through links, and no pipe is waited for."""

import errno
import os
import stat
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING, BinaryIO, TypeVar

if TYPE_CHECKING:  # Commands check names of files before pydantic is needed.
    from pydantic import ValidationError

    from mimoc.schema.base import Model

MAX_BYTES = 2**26  # Largest size of one file; 64 MB.
MAX_BYTES_IN_ALL = 2**27  # Largest size of all files of a bundle; infants with the densest skin have a tenth.
MAX_FILES = 4096
MAX_NESTED = 8

_TOP = PurePosixPath(".")
_FOLDER = os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW | os.O_CLOEXEC
_LINK = (errno.ELOOP, errno.EMLINK)  # Errors of opening a file that is a link.
_LINK_MET = (*_LINK, errno.ENOTDIR)  # Errors of opening a file or, the last, a folder that is a link.
_LINK_TEXT = "is a link, which mimoc never writes"
_FILE = os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC


class UnusableFileError(Exception):
    """A file is a link, a pipe or a device, too large, or not what mimoc writes."""


class RegularFiles:
    """Reads files of one folder."""

    def __init__(self, folder: int, handles: ExitStack, most_bytes_in_all: int):
        """Read from a folder that is open, and keep others open until *handles* is closed."""
        self._folders, self._handles = {_TOP: folder}, handles
        self._left = most_bytes_in_all

    def read(self, name: str, most_bytes: int = MAX_BYTES) -> bytes | None:
        """Return the content of a file, None if there is none; UnusableFileError if not regular, or too large."""
        file = self.open(name, min(most_bytes, self._left))
        if file is None:
            return None
        try:
            content = _content(file)
        except OSError:
            return None
        self._left -= len(content)
        return content

    def open(self, name: str, most_bytes: int) -> BinaryIO | None:
        """Return a file opened for reading; see `read`."""
        path = PurePosixPath(name)
        try:
            return _open(path.name, most_bytes, self._folder(path.parent))
        except OSError as error:
            if error.errno in _LINK_MET:
                raise UnusableFileError(_LINK_TEXT) from None
            return None

    def read_all(self, names: Sequence[str], most_bytes: int) -> list[bytes]:
        """Return many files of the folder itself, three times as fast, or an UnusableFileError that names one."""
        return [self._content_at_once(name, most_bytes) for name in names]

    def _content_at_once(self, name: str, most_bytes: int) -> bytes:
        try:
            handle = os.open(name, os.O_RDONLY | _FILE, dir_fd=self._folders[_TOP])
        except OSError as error:
            reason = _LINK_TEXT if error.errno in _LINK else f"cannot be read ({error.strerror})"
            raise UnusableFileError(f"{name} {reason}") from None
        try:
            status = os.fstat(handle)
            if not stat.S_ISREG(status.st_mode):
                raise UnusableFileError(f"{name} is not a regular file")
            if status.st_size > min(most_bytes, self._left):
                raise UnusableFileError(f"{name} is too large, or all files together are")
            self._left -= status.st_size
            return os.read(handle, status.st_size)
        except OSError as error:
            raise UnusableFileError(f"{name} cannot be read ({error.strerror})") from None
        finally:
            os.close(handle)

    def names(self, folder: str = ".") -> list[str]:
        """Return the sorted names of what is in a folder, if there is one; of a link, raise an UnusableFileError."""
        try:
            return sorted(os.listdir(self._folder(PurePosixPath(folder))))
        except OSError as error:
            if error.errno in _LINK_MET:
                raise UnusableFileError("is a link, or not a folder") from None
            return []

    def _folder(self, path: PurePosixPath) -> int:
        if path not in self._folders:
            above = self._folder(path.parent)
            handle = os.open(path.name, _FOLDER, dir_fd=above)
            self._handles.callback(os.close, handle)
            self._folders[path] = handle
        return self._folders[path]


@contextmanager
def regular_files(folder: Path, most_bytes_in_all: int = MAX_BYTES_IN_ALL) -> Iterator[RegularFiles]:
    """Open a folder, which may itself be a link, to read its files; an OSError says that it cannot be opened."""
    with ExitStack() as handles:
        handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        handles.callback(os.close, handle)
        yield RegularFiles(handle, handles, most_bytes_in_all)


def read_regular_file(path: Path, most_bytes: int = MAX_BYTES, *, below: Path | None = None) -> bytes | None:
    """Return the content of a file, None if it does not exist or cannot be read.

    No folder between it and one above, *below*, by default its own, may be a link. Raises an UnusableFileError if it is
    not a regular file, or larger than *most_bytes*.
    """
    try:
        if below is None:  # By its path at once: another process may replace its folder meanwhile.
            return _content(_open(path, most_bytes))
        with regular_files(below, most_bytes) as files:
            return files.read(path.relative_to(below).as_posix(), most_bytes)
    except OSError as error:
        if error.errno in _LINK:
            raise UnusableFileError(_LINK_TEXT) from None
        return None


def open_regular_file(path: Path, most_bytes: int, *, below: Path) -> BinaryIO | None:
    """Return a file opened for reading; see `read_regular_file`."""
    try:
        with regular_files(below) as files:
            return files.open(path.relative_to(below).as_posix(), most_bytes)
    except OSError:
        return None


def is_regular_file(path: Path) -> bool:
    """Return whether there is a file that is neither a link nor a pipe nor a device."""
    try:
        return stat.S_ISREG(os.lstat(path).st_mode)
    except OSError:
        return False


def _content(file: BinaryIO) -> bytes:
    """Return the content of a file, or what is left of it if it was cut meanwhile, and close it."""
    with file:
        return file.read(os.fstat(file.fileno()).st_size)


def _open(name: str | Path, most_bytes: int, folder: int | None = None) -> BinaryIO:
    file = open(name, "rb", opener=lambda path, flags: os.open(path, flags | _FILE, dir_fd=folder))  # noqa: SIM115
    status = os.fstat(file.fileno())
    if stat.S_ISREG(status.st_mode) and status.st_size <= most_bytes:
        return file
    file.close()
    is_file = stat.S_ISREG(status.st_mode)
    raise UnusableFileError("is larger than those of any infant" if is_file else "is not a regular file")


MAX_JSON_BYTES = 2**22  # Largest size of a JSON file, unless its reader knows better; 4 MB.
_MAX_LISTED = 3

Data = TypeVar("Data", bound="Model")


def read_json_file(
    path: Path, kind: type[Data], most_bytes: int = MAX_JSON_BYTES, *, below: Path | None = None
) -> Data | None:
    """Return the content of a JSON file as data of a type; None if it does not exist or cannot be read.

    Nothing is converted: text is no number, and a number no text. See `read_regular_file` for the other arguments.

    Raises:
        UnusableFileError: If it is not a regular file, too large, or contains anything else: one line to write after
            the path and a colon.
    """
    content = read_regular_file(path, most_bytes, below=below)
    return None if content is None else parse_json(content, kind)


def parse_json(content: bytes, kind: type[Data]) -> Data:
    """Return JSON as data of a type, or raise an UnusableFileError; see `read_json_file`."""
    from pydantic import ValidationError

    try:
        return kind.model_validate_json(content, strict=True)
    except ValidationError as error:
        raise UnusableFileError(problems_in(error)) from None


def problems_in(error: "ValidationError") -> str:
    """Return what is wrong with the data of a file, key by key, in one line of printable text."""
    problems = [
        ": ".join([".".join(map(str, problem["loc"])), problem["msg"].removeprefix("Value error, ")]).removeprefix(": ")
        for problem in error.errors(include_url=False, include_context=False, include_input=False)
    ]
    return one_line(first_of(problems, _MAX_LISTED))


def first_of(problems: Sequence[str], most: int) -> str:
    """Return the first problems in one line, and how many more there are."""
    more = [f"and {len(problems) - most} more"] if len(problems) > most else []
    return "; ".join([*problems[:most], *more])


def one_line(text: str) -> str:
    """Return a text of which some comes from anyone, with question marks in place of characters that do not print."""
    return "".join(character if character.isprintable() else "?" for character in text)

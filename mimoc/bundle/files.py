"""Writing files and folders: each whole or not at all, and nothing left over of processes that were killed."""

import ctypes
import errno
import os
import secrets
import shutil
import socket
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from glob import escape
from hashlib import sha256
from pathlib import Path

from mimoc.base.errors import OutputError
from mimoc.bundle.regular_files import UnusableFileError, read_regular_file

PAGES = (".html", ".htm")  # What the name of a page ends in.
_PREFIX, _SUFFIX = ".mimoc-", ".tmp"


def check_page(file: str | Path) -> Path:
    """Return the path of a page that can be written to a file, or raise an OutputError before anything takes time."""
    path = Path(file).expanduser()
    if path.suffix.lower() not in PAGES:
        raise OutputError(f"{path}: not the name of a page; end it in {' or '.join(PAGES)}")
    if not path.parent.is_dir():
        raise OutputError(f"{path}: there is no folder {path.parent}; make it, or choose another place")
    return path


def write_file(path: str | Path, content: bytes, *, below: Path | None = None) -> Path:
    """Write a file into an existing folder atomically: a reader sees either the old content or the new.

    A link in its place is replaced, and never followed; no folder between it and one above, *below*, may be a link.

    Raises:
        OutputError: If the file cannot be written.
    """
    path = Path(path).expanduser()
    if below is not None:
        check_unlinked(path.parent, below=below)
    temporary = temporary_path(path)
    try:
        temporary.write_bytes(content)
    except OSError as error:
        discard(temporary)
        raise write_error(path, error) from None
    return move_into_place(temporary, path)


def check_unlinked(path: Path, *, below: Path) -> Path:
    """Return a path, or raise an OutputError if it or a folder between it and one above leads somewhere else."""
    place = below
    for name in path.relative_to(below).parts:
        place /= name
        if place.is_symlink():
            raise OutputError(f"{place}: this is a link, through which mimoc writes nothing; remove it")
    return path


def make_folder(path: Path, *, below: Path) -> Path:
    """Make a folder, and those between it and one above, or raise an OutputError, also if one is a link."""
    try:
        check_unlinked(path, below=below).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise write_error(path, error) from None
    return path


def open_new_file(path: Path, *, below: Path) -> int:
    """Return the handle of a new, empty file, opened for writing; whatever file or link has its name is removed first.

    Its folder is made if it does not exist. An OutputError says that it cannot be written; see `make_folder`.
    """
    make_folder(path.parent, below=below)
    try:
        path.unlink(missing_ok=True)
        return os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW | os.O_CLOEXEC, 0o666)
    except OSError as error:
        raise write_error(path, error) from None


def temporary_path(path: Path) -> Path:
    """Return the path of a temporary file in the same folder, to be renamed to *path* when it is complete."""
    return path.parent / f"{unfinished_name(_PREFIX)}{_SUFFIX}"


def remove_temporary_files(folder: Path) -> None:
    """Remove the temporary files in a folder that killed processes of this machine have left behind."""
    remove_leftovers(folder, _PREFIX)


def move_into_place(temporary: Path, path: Path) -> Path:
    """Rename a complete temporary file to *path*, whatever is there; remove it and raise an OutputError if not."""
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


def unfinished_name(prefix: str) -> str:
    """Return a new name, which begins with *prefix*, for a file or folder that this process is writing."""
    return f"{writer_prefix(prefix)}{os.getpid()}-{secrets.token_hex(8)}"


def writer_prefix(prefix: str) -> str:
    """Return what comes before the process ID in the names of all that this machine's processes are writing."""
    return f"{prefix}{socket.gethostname()}-{_process_namespace()}-"


def remove_leftovers(folder: Path, prefix: str) -> None:
    """Remove the files and folders with unfinished names whose processes, on this machine, no longer exist."""
    ours = writer_prefix(prefix)
    for path in folder.glob(f"{escape(ours)}*"):
        process = path.name.removeprefix(ours).split("-")[0]
        if process.isdecimal() and not _is_alive(int(process)):
            remove(path)


def remove(path: Path) -> None:
    """Remove what is at a path, a folder with all that is in it, as far as it can be removed.

    `shutil.rmtree` alone would wait for somebody to write to a pipe.
    """
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path, ignore_errors=True)
    else:
        with suppress(OSError):
            path.unlink()


def _process_namespace() -> str:
    """Return the ID of the process namespace: containers on one machine number their processes separately."""
    try:
        return str(os.stat("/proc/self/ns/pid").st_ino)
    except OSError:
        return "0"


def _is_alive(process: int) -> bool:
    try:
        os.kill(process, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:
        return True
    return True


_AT_FDCWD = -100
_RENAME_EXCHANGE = 2
"""Flag of renameat2 (Linux, include/uapi/linux/fs.h) and, as RENAME_SWAP, of renamex_np (macOS, sys/stdio.h)."""
_UNSUPPORTED = {errno.ENOSYS, errno.EINVAL, errno.ENOTSUP}
"""Errors of an operating or file system that cannot swap two folders atomically."""


@contextmanager
def staged_folder(target: Path, *, force: bool = False) -> Iterator[Path]:
    """Yield an empty folder that replaces a new or empty one, or any by *force*, or raise an OutputError."""
    place = Path(os.path.realpath(target))
    prefix = f".{place.name}{_PREFIX}"
    staging = place.parent / unfinished_name(prefix)
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        remove_leftovers(place.parent, prefix)
        staging.mkdir()
        yield staging
        if force and place.is_dir() and any(place.iterdir()):
            swap_folders(staging, place)
        else:
            if place.is_dir():
                place.rmdir()
            os.rename(staging, place)
    except OSError as error:
        raise OutputError(f"{target}: cannot be written ({error.strerror}); choose another folder") from None
    finally:
        shutil.rmtree(staging, ignore_errors=True)


def check_place(target: Path) -> None:
    """Raise an OutputError if a file or a folder cannot be made there, before anything that takes long."""
    folder = Path(os.path.realpath(target)).parent
    while not os.path.lexists(folder):
        folder = folder.parent
    trial = folder / unfinished_name(f".{target.name}{_PREFIX}")
    try:
        trial.mkdir()
        trial.rmdir()
    except OSError as error:
        raise OutputError(f"{target}: cannot be written ({error.strerror}); choose another place") from None


def swap_folders(first: Path, second: Path) -> None:
    """Swap two folders of one file system.

    If the system cannot do this atomically, *second* is first moved aside, and moved back if *first* cannot be
    renamed. An OSError says that they are not swapped.
    """
    try:
        _swap_at_once(os.fsencode(first), os.fsencode(second))
    except OSError as error:
        if error.errno not in _UNSUPPORTED:
            raise
        aside = Path(tempfile.mkdtemp(prefix=f"{first.name}-", dir=first.parent))
        os.rename(second, aside)
        try:
            os.rename(first, second)
        except BaseException:
            os.rename(aside, second)
            raise
        os.rename(aside, first)


def _swap_at_once(first: bytes, second: bytes) -> None:
    library = ctypes.CDLL(None, use_errno=True)
    if sys.platform == "linux" and hasattr(library, "renameat2"):
        failed = library.renameat2(_AT_FDCWD, first, _AT_FDCWD, second, _RENAME_EXCHANGE)
    elif sys.platform == "darwin" and hasattr(library, "renamex_np"):
        failed = library.renamex_np(first, second, _RENAME_EXCHANGE)
    else:
        raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))
    if failed:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))


@dataclass(frozen=True, slots=True)
class SharedFiles:
    """A folder of files by digest, on the file system of the bundles that share them."""

    folder: Path

    def put(self, path: Path, content: bytes) -> None:
        """Write a file as a link to the shared one, or a copy without links; OutputError if its folder is a link."""
        digest = sha256(content).hexdigest()
        shared = self.folder / digest[:2] / digest
        if not self._link(shared, path, content):
            path.write_bytes(content)
            self._share(path, shared)

    def _link(self, shared: Path, path: Path, content: bytes) -> bool:
        """Make a file a link to the shared one, if that has its content; return whether it is one now."""
        try:
            if read_regular_file(shared, below=self.folder) != content:
                return False
            os.link(shared, path, follow_symlinks=False)
        except (OSError, UnusableFileError):  # It has as many links as the file system allows, or there are none.
            return False
        return True

    def _share(self, path: Path, shared: Path) -> None:
        """Let later bundles link to a file, if the file system can."""
        make_folder(shared.parent, below=self.folder)
        temporary = temporary_path(shared)
        try:
            os.link(path, temporary)
            os.replace(temporary, shared)
        except OSError:
            discard(temporary)

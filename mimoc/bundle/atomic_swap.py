"""Swap two folders atomically, so that each name refers to a folder at all times."""

import ctypes
import errno
import os
import sys
import tempfile
from pathlib import Path

_AT_FDCWD = -100
_RENAME_EXCHANGE = 2
"""Flag of renameat2 (Linux, include/uapi/linux/fs.h) and, as RENAME_SWAP, of renamex_np (macOS, sys/stdio.h)."""
_UNSUPPORTED = {errno.ENOSYS, errno.EINVAL, errno.ENOTSUP}
"""Errors of an operating or file system that cannot swap two folders atomically."""


def swap_folders(first: Path, second: Path) -> None:
    """Swap two folders of one file system.

    If the system cannot do this atomically, *second* is first moved aside, and moved back if *first* cannot be
    renamed.

    Raises:
        OSError: If they cannot be swapped.
    """
    try:
        _swap_at_once(os.fsencode(first), os.fsencode(second))
    except OSError as error:
        if error.errno not in _UNSUPPORTED:
            raise
        _swap_in_turn(first, second)


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


def _swap_in_turn(first: Path, second: Path) -> None:
    aside = Path(tempfile.mkdtemp(prefix=f"{first.name}-", dir=first.parent))
    os.rename(second, aside)
    try:
        os.rename(first, second)
    except BaseException:
        os.rename(aside, second)
        raise
    os.rename(aside, first)

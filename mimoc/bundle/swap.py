"""Two folders change places in one step, so that neither name is ever without a folder."""

import ctypes
import errno
import os
import sys
import tempfile
from pathlib import Path

_AT_FDCWD = -100
_RENAME_EXCHANGE = 2
"""Of renameat2 (Linux, include/uapi/linux/fs.h) and, as RENAME_SWAP, of renamex_np (macOS, sys/stdio.h)."""
_CANNOT = {errno.ENOSYS, errno.EINVAL, errno.ENOTSUP}
"""What an operating or file system answers that does not know how."""


def exchange(first: Path, second: Path) -> None:
    """Swap two folders of one file system.

    Where the system cannot do it in one step, *second* is moved away for an instant, and back if *first*
    cannot take its place.

    Raises:
        OSError: If they cannot be swapped.
    """
    try:
        _exchange_at_once(os.fsencode(first), os.fsencode(second))
    except OSError as error:
        if error.errno not in _CANNOT:
            raise
        _exchange_in_turn(first, second)


def _exchange_at_once(first: bytes, second: bytes) -> None:
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


def _exchange_in_turn(first: Path, second: Path) -> None:
    aside = Path(tempfile.mkdtemp(prefix=f"{first.name}-", dir=first.parent))
    os.rename(second, aside)
    try:
        os.rename(first, second)
    except BaseException:
        os.rename(aside, second)
        raise
    os.rename(aside, first)

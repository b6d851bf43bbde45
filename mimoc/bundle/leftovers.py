"""What killed processes have left half-written: their names say who wrote them, and on which machine."""

import os
import secrets
import shutil
import socket
from contextlib import suppress
from glob import escape
from pathlib import Path


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

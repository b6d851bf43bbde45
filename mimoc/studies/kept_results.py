"""Parts of a study: results that outlive an interruption, and processes that trials run in."""

import json
import os
import signal
from collections.abc import Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from threading import Thread
from typing import Any, TypeVar

from mimoc.bundle.files import make_folder, write_file
from mimoc.bundle.io import digests
from mimoc.bundle.regular_files import UnusableFileError, read_json_file
from mimoc.fits.tables import data_files
from mimoc.recording.folder import versions
from mimoc.schema.base import Model

Result = TypeVar("Result", bound=Model)


@cache
def software() -> Mapping[str, str]:
    """Return what decides a result besides what is asked: digests of mimoc's own files, and versions of libraries."""
    package = Path(__file__).resolve().parents[1]
    files = {path.relative_to(package).as_posix(): path for path in package.rglob("*") if path.is_file()}
    contents = {name: path.read_bytes() for name, path in files.items() if "__pycache__" not in name}
    contents |= {f"data/{name}": table for name, table in data_files().items()}
    return {**versions(), **digests(contents)}


def kept_file(folder: Path, name: str, *what: Any) -> Path:
    """Return the file of a result in a folder; *what* decides it besides the software, as data for JSON."""
    text = json.dumps([name, what, software()], sort_keys=True)
    return folder / f"{name}-{sha256(text.encode()).hexdigest()[:16]}.json"


def keep(path: Path, result: Model, *, below: Path) -> None:
    """Write a result into the folder of a study, *below*; raise an OutputError if it cannot be written."""
    make_folder(path.parent, below=below)
    write_file(path, f"{result.model_dump_json()}\n".encode(), below=below)


def read_kept(path: Path, kind: type[Result], *, below: Path) -> Result | None:
    """Return the result in a file; None if there is none, or it is damaged, so that it is done again."""
    try:
        return read_json_file(path, kind, below=below)
    except UnusableFileError:
        return None


@contextmanager
def process_pool(processes: int) -> Iterator[ProcessPoolExecutor]:
    """Yield a pool of processes that start anew, and leave Ctrl-C to the one that asks for it.

    When that leaves the context, by whatever exception, or is itself ended, they end at once, whatever they are at.
    """
    context = get_context("spawn")
    theirs, ours = context.Pipe(duplex=False)
    with theirs, ours, ProcessPoolExecutor(processes, context, _begin, (theirs,)) as pool:
        try:
            yield pool
        except BaseException:
            ours.close()
            pool.shutdown(cancel_futures=True)
            raise


def _begin(lifeline: Connection) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with, args=(lifeline,), daemon=True).start()


def _end_with(lifeline: Connection) -> None:
    """End this process when the other end of a connection is closed, or the process that has it ends."""
    with suppress(EOFError, OSError):
        lifeline.recv_bytes()
    os._exit(1)

"""What tries to break mimoc with input from strangers: many tries, each known by a seed and a number.

A fuzzer is one module with `FUZZER`, listed in `FUZZERS`. `.ci/task fuzz` runs them for minutes, `make test` briefly.
"""

import ctypes
import os
import resource
import struct
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.errors import MimocError, SpecError

TOUCHED = 0x20 | 0x2 | 0x40 | 0x80 | 0x100 | 0x200
"""IN_OPEN, IN_MODIFY, IN_MOVED_FROM, IN_MOVED_TO, IN_CREATE and IN_DELETE (inotify(7))."""
IN_NONBLOCK = os.O_NONBLOCK
HEADER = struct.Struct("iIII")
"""Of an event: watch, mask, cookie, and the length of the name that follows (inotify(7))."""


class Canaries:
    """A folder of files outside of all bundles, with a few that a stranger's bundle may refer to."""

    def __init__(self, folder: Path, contents: dict[str, bytes]):
        folder.mkdir(parents=True)
        for name, content in contents.items():
            (folder / name).write_bytes(content)
        self.folder = folder
        library = ctypes.CDLL(None, use_errno=True)
        self._handle = library.inotify_init1(IN_NONBLOCK)
        if self._handle < 0 or library.inotify_add_watch(self._handle, os.fsencode(folder), TOUCHED) < 0:
            raise OSError(ctypes.get_errno(), "cannot watch", str(folder))

    def opened(self) -> list[str]:
        """Return the names of the files that have been opened, made, changed or removed since the last call.

        A dot stands for the folder itself, which was listed.
        """
        try:
            events = os.read(self._handle, 2**16)
        except BlockingIOError:
            return []
        names, place = set[str](), 0
        while place < len(events):
            length = HEADER.unpack_from(events, place)[3]
            name = events[place + HEADER.size : place + HEADER.size + length]
            names.add(os.fsdecode(name.rstrip(b"\0")) or ".")
            place += HEADER.size + length
        return sorted(names)

    def close(self) -> None:
        os.close(self._handle)


FUZZERS = (
    *("bundles", "policies", "recordings", "specs", "meshes", "pictures", "scenes"),
    *("cohorts", "trainings", "honest_cohorts", "honest_specs", "points", "small_files"),
)
"""Modules beside this one."""
LONGEST_S = 5.0
LARGEST_MB = 1024  # Of a process that has imported everything, with what a try takes.


@dataclass(frozen=True, slots=True)
class Fuzzer:
    prepare: Callable[[Path], Any]  # Returns what all tries begin with; it may write into a folder of its own.
    attempt: Callable[[Any, np.random.Generator, Path], None]
    """Spoils it by chance, and uses it, in an empty folder; what is refused raises a MimocError."""
    short: int  # Tries in `make test`: a second or two.
    longest_s: float = LONGEST_S  # CPU time that a try may take.
    largest_mb: int = LARGEST_MB  # Memory that a process may ever have.
    honest: bool = False  # Whether what is tried is spoilt by nobody, so that nothing need be refused.


@dataclass(frozen=True, slots=True)
class Outcome:
    number: int
    result: str
    """`used`, `refused`, or what is wrong with mimoc: the end of a traceback, or an outside file that was opened."""

    @property
    def is_fault(self) -> bool:
        return self.result not in ("used", "refused")


def fuzzer(name: str) -> Fuzzer:
    return import_module(f"fuzz.{name}").FUZZER


def run_try(made: Fuzzer, prepared: Any, seed: int, number: int, folder: Path, watch: Canaries) -> Outcome:
    """Return what becomes of one try, the same for the same seed and number.

    Args:
        made: The fuzzer.
        prepared: What it has prepared.
        seed: Of the run.
        number: Of the try.
        folder: An empty folder.
        watch: Files outside that nobody may open.
    """
    try:
        made.attempt(prepared, np.random.default_rng([seed, number]), folder)
        result = "used"
    except MimocError as error:
        result = "refused" if is_clear(error) else f"not clear: {error!r}"
    except Exception:
        result = " | ".join(traceback.format_exc().strip().splitlines()[-7:])
    if opened := watch.opened():
        result = f"opened outside files: {', '.join(opened)}"
    return Outcome(number, result)


def is_clear(error: MimocError) -> bool:
    """Return whether an error is a line of text that a terminal shows as it is; of a spec, a line for each problem."""
    lines = str(error).split("\n")
    return all(line and line.isprintable() for line in lines) and (len(lines) == 1 or isinstance(error, SpecError))


def check_clear(error: MimocError) -> None:
    assert is_clear(error), f"not clear: {error!r}"


def peak_mb() -> float:
    """Return the most memory that this process, or one that it started, has ever had."""
    return max(resource.getrusage(who).ru_maxrss for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)) / 1024

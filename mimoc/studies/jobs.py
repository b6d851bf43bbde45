"""Jobs of a study, done side by side in processes, and results that outlive an interruption.

store = JobStore(folder, "trials", Result)
results = store.complete(keys, lambda missing: run_jobs(trial, [jobs[place] for place in missing], processes))
"""

import json
import os
import signal
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from multiprocessing import get_context
from multiprocessing.connection import Connection
from pathlib import Path
from threading import Thread
from typing import Any, Generic, NamedTuple, TypeVar

from mimoc.base.errors import MimocError
from mimoc.bundle.files import make_folder, remove, write_file
from mimoc.bundle.io import digests
from mimoc.bundle.regular_files import UnusableFileError, read_json_file
from mimoc.fits.tables import data_files
from mimoc.recording.folder import versions
from mimoc.schema.base import Model

Result = TypeVar("Result", bound=Model)
Value = TypeVar("Value")
Progress = Callable[[int, int], None]  # Called with how much is done, and how much there is to do.
Key = Sequence[Any]
"""What decides the result of a job besides the software, as data for JSON; first the name that its file begins with."""


@cache
def software() -> Mapping[str, str]:
    """Return what decides a result besides what is asked: digests of mimoc's own files, and versions of libraries."""
    package = Path(__file__).resolve().parents[1]
    files = {path.relative_to(package).as_posix(): path for path in package.rglob("*") if path.is_file()}
    contents = {name: path.read_bytes() for name, path in files.items() if "__pycache__" not in name}
    contents |= {f"data/{name}": table for name, table in data_files().items()}
    return {**versions(), **digests(contents)}


@dataclass(frozen=True)
class JobStore(Generic[Result]):
    """Results of one kind in a folder of a study, each in a file of its own as soon as its job is done."""

    study: Path
    folder: str  # Name of the folder, within that of the study.
    kind: type[Result]

    def complete(
        self,
        keys: Sequence[Key],
        run: Callable[[Sequence[int]], Iterable[tuple[int, Result]]],
        finished: Callable[[int], Any] = lambda place: None,
    ) -> list[Result]:
        """Return the result of each key, in their order; those that the same software had earlier are read.

        Args:
            keys: The key of each job.
            run: Does the jobs at some places among the keys, and yields the index among those places and the result of
                each as it comes. It is not called if nothing is missing.
            finished: Called with the place of each job that has a result, including those that were read.

        Raises:
            OutputError: If a result cannot be written.
        """
        files = [self._file(key) for key in keys]
        results = {place: result for place, file in enumerate(files) if (result := self._read(file))}
        for place in results:
            finished(place)
        missing = [place for place in range(len(keys)) if place not in results]
        for index, result in run(missing) if missing else ():
            place = missing[index]
            make_folder(self.study / self.folder, below=self.study)
            write_file(files[place], f"{result.model_dump_json()}\n".encode(), below=self.study)
            results[place] = result
            finished(place)
        return [results[place] for place in range(len(keys))]

    def clear(self) -> None:
        """Remove all results, so that the next study begins anew."""
        remove(self.study / self.folder)

    def _file(self, key: Key) -> Path:
        name, *what = key
        text = json.dumps([name, what, software()], sort_keys=True)
        return self.study / self.folder / f"{name}-{sha256(text.encode()).hexdigest()[:16]}.json"

    def _read(self, path: Path) -> Result | None:
        """Return the result in a file; None if there is none, or it is damaged, so that its job is done again."""
        try:
            return read_json_file(path, self.kind, below=self.study)
        except UnusableFileError:
            return None


def run_jobs(
    function: Callable[..., Value], jobs: Sequence[Sequence[Any]], processes: int
) -> Iterator[tuple[int, Value]]:
    """Call a function with the arguments of each job; yield the place of each job and its result as it comes.

    With one process, all are done in this one, in their order; with more, function and arguments are pickled.
    """
    if processes == 1 or len(jobs) < 2:
        for place, arguments in enumerate(jobs):
            yield place, function(*arguments)
        return
    with process_pool(min(processes, len(jobs))) as pool:
        running = {pool.submit(_answer, function, *arguments): place for place, arguments in enumerate(jobs)}
        for future in as_completed(running):
            answer = future.result()
            if isinstance(answer, _Failure):
                raise answer.kind(answer.message)
            yield running[future], answer


class _Failure(NamedTuple):
    """An error of mimoc's on its way between processes, for which not all of them are made."""

    kind: type[MimocError]
    message: str


def _answer(function: Callable[..., Value], *arguments: Any) -> Value | _Failure:
    try:
        return function(*arguments)
    except MimocError as error:
        takes_a_message = type(error).__init__ is MimocError.__init__
        return _Failure(type(error) if takes_a_message else MimocError, str(error))


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

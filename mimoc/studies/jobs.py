"""Jobs of a study, done side by side in processes, and results that outlive an interruption.

store = JobStore(folder, "trials", Result)
results = store.complete(keys, lambda missing: run_jobs(trial, [jobs[place] for place in missing], processes))
"""

import json
import os
import socket
import subprocess
import sys
from collections import deque
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from multiprocessing.connection import Connection, wait
from pathlib import Path
from pickle import dumps, loads
from runpy import run_path
from threading import Thread
from traceback import format_exc
from types import ModuleType
from typing import Any, Generic, TypeVar

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
PATIENCE_S = 5.0  # How long to wait for the end of a process that does nothing.
POLL_S = 1.0  # How often to look for processes that have ended in silence.
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
    with workers(min(processes, len(jobs))) as idle:
        waiting, doing = deque(enumerate(jobs)), dict[Worker, int]()
        while waiting or doing:
            while waiting and idle:
                worker = idle.pop()
                doing[worker], arguments = waiting.popleft()
                worker.begin(function, *arguments)
            for worker in ready(doing):
                place = doing.pop(worker)
                yield place, worker.finish()
                idle.append(worker)


class WorkerEndedError(MimocError):
    """A process has ended instead of doing its job."""


class Worker:
    """A process that does one job after the other, and ends when this one does, however it ends.

    It starts anew, with some environment variables of its own. Ctrl-C is for this process, which then ends the others.
    """

    def __init__(self, environment: Mapping[str, str] | None = None):
        ours, theirs = socket.socketpair()
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-c", f"from mimoc.studies.jobs import serve; serve({theirs.fileno()})"],
                stdin=subprocess.PIPE,  # It ends when this is closed, even if this process is killed.
                env={**os.environ, **(environment or {}), "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
                pass_fds=[theirs.fileno()],
                start_new_session=True,
            )
        self.connection = Connection(ours.detach())
        self._is_busy = False

    @property
    def has_ended(self) -> bool:
        """Whether the process has ended."""
        return self._process.poll() is not None

    def begin(self, function: Callable[..., Any], *arguments: Any) -> None:
        """Have a function called; one of the main module takes that along, which has to guard its main part."""
        self._is_busy, job = True, dumps((function, arguments))
        main = getattr(sys.modules["__main__"], "__file__", None) if b"__main__" in job else None
        with suppress(OSError):  # It has ended: `finish` tells.
            self.connection.send((main, job))

    def finish(self, within_s: float | None = None) -> Any:
        """Wait for the function; return what it returned, or raise what it raised.

        Raises:
            WorkerEndedError: If the process has ended instead, or does not answer *within_s*.
        """
        try:
            if not self.connection.poll(0 if self.has_ended else within_s):
                raise EOFError
            error, answer = self.connection.recv()
        except (EOFError, OSError):
            raise WorkerEndedError(self.end()) from None
        self._is_busy = False
        if error:
            raise error
        return answer

    def end(self) -> str:
        """End the process, and say how it ended if it has done so by itself."""
        self.connection.close()
        if not self._is_busy:
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(PATIENCE_S)
        self._process.kill()
        self._process.communicate()
        code = self._process.returncode
        return f"the process was killed by signal {-code}" if code < 0 else f"the process ended with exit code {code}"


def ready(busy: Collection[Worker]) -> list[Worker]:
    """Wait a moment; return the workers that have done their jobs or have ended."""
    answered = wait([worker.connection for worker in busy], POLL_S)
    return [worker for worker in busy if worker.connection in answered or worker.has_ended]


@contextmanager
def workers(number: int) -> Iterator[list[Worker]]:
    """Yield processes that do jobs; when the context is left, by whatever exception, they end at once."""
    made = list[Worker]()
    try:
        made += (Worker() for _ in range(number))
        yield list(made)
    finally:
        for worker in made:
            worker.end()


def serve(descriptor: int) -> None:
    """Do the jobs that come over a connection to the process that has started this one, and answer each."""
    os.set_inheritable(descriptor, False)
    lifeline, nothing = os.dup(0), os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    Thread(target=_end_with, args=(lifeline,), daemon=True).start()
    connection = Connection(descriptor)
    with suppress(EOFError, ConnectionError):  # There are no more jobs, or nobody waits for the answer.
        while True:
            main, job = connection.recv()
            if main and sys.modules["__main__"].__name__ != "__mp_main__":
                module = sys.modules["__main__"] = sys.modules["__mp_main__"] = ModuleType("__mp_main__")
                vars(module).update(run_path(main, run_name="__mp_main__"))
            try:
                function, arguments = loads(job)
                answer = (None, function(*arguments))
            except Exception as error:
                answer = (_sendable(error), None)
            connection.send(answer)


def _end_with(lifeline: int) -> None:
    """End this process when the one that started it ends, however it ends."""
    while os.read(lifeline, 1):
        pass
    os._exit(1)


def _sendable(error: Exception) -> Exception:
    """Return an error that can be made again from its message alone, as another process has to."""
    if isinstance(error, MimocError) and type(error).__init__ is not MimocError.__init__:
        return MimocError(str(error))
    try:
        loads(dumps(error))
    except Exception:  # Whatever its class does then.
        return RuntimeError(f"{type(error).__name__}: {error}")
    error.add_note(format_exc())
    return error

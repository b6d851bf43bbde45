"""Jobs in processes on this machine, and such a process (`python -m mimoc.studies.cohorts.engines.local`)."""

import os
import socket
import subprocess
import sys
from collections import deque
from collections.abc import Mapping, Sequence
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from threading import Thread
from time import monotonic
from typing import Any

from mimoc.base.errors import MimocError
from mimoc.studies.cohorts.job import Job
from mimoc.studies.cohorts.run_jobs import PINNED, failed_result, run_jobs
from mimoc.studies.cohorts.store import Result, Store

OPTIONS = ("processes",)
WORKER = "mimoc.studies.cohorts.engines.local"
TRIES = 2  # How often a job is begun whose process is killed.
PATIENCE_S = 5.0  # How long to wait for the end of a process that does nothing.
POLL_S = 1.0  # How often to look for processes that have ended in silence.


def run(jobs: Sequence[Job], store: Store, options: Mapping[str, Any], done: Any) -> None:
    """Do jobs in as many processes as this one may use cores, or as `processes` says.

    A job whose process is killed is begun again in another, and fails if that is killed as well.
    """
    number = options.get("processes") or len(os.sched_getaffinity(0))
    queue, tries, finished = Queue(jobs), dict[str, int](), 0
    workers: list[_Worker] = []
    try:
        while queue or any(worker.job for worker in workers):
            while queue and len(workers) < min(number, len(jobs)):
                workers.append(_Worker(store))
            for worker in workers:
                if queue and not worker.job:
                    worker.begin(queue.next(worker.infant))
            busy = [worker for worker in workers if worker.job]
            ready = wait([worker.connection for worker in busy], POLL_S)
            for worker in [worker for worker in busy if worker.connection in ready or worker.has_ended]:
                job, answered = worker.finish()
                if not answered:
                    workers.remove(worker)
                    ended = worker.end()
                    tries[job.key] = tries.get(job.key, 0) + 1
                    if tries[job.key] < TRIES:
                        queue.again(job)
                        continue
                    store.write(job, failed_result(job, f"{ended}, {TRIES} times; see the log"))
                finished += 1
                done(finished)
    finally:
        for worker in workers:
            worker.end()


def check(options: Mapping[str, Any]) -> None:
    """Check the number of processes; raise a MimocError if there would be none."""
    if (number := options.get("processes") or 1) < 1:
        raise MimocError(f"{number} processes can do nothing; give at least 1")


def try_out(jobs: Sequence[Job], store: Store, limit_s: float) -> list[Result | None]:
    """Do jobs one after the other in one process; return their results, None for those that a time limit stops."""
    worker, end_s = _Worker(store), monotonic() + limit_s
    try:
        for job in jobs:
            worker.begin(job)
            if not worker.connection.poll(max(end_s - monotonic(), 0.0)) or not worker.finish()[1]:
                break
    finally:
        worker.end()
    return [store.read(job) for job in jobs]


class _Worker:
    """A process that does one job after the other."""

    def __init__(self, store: Store):
        ours, theirs = socket.socketpair()
        with theirs:
            self._process = subprocess.Popen(
                [sys.executable, "-m", WORKER, str(theirs.fileno())],
                stdin=subprocess.PIPE,  # It ends when this is closed, even if this process is killed.
                env={**os.environ, **PINNED, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
                pass_fds=[theirs.fileno()],
                start_new_session=True,  # Ctrl-C is for this process, which then ends the others.
            )
        self.connection = Connection(ours.detach())
        self._store = store
        self.job: Job | None = None
        self.infant = ""

    def begin(self, job: Job) -> None:
        self.job, self.infant = job, job.infant
        with suppress(OSError):  # It has ended: the answer will tell.
            self.connection.send((job, self._store))

    def finish(self) -> tuple[Job, bool]:
        """Return its job, and whether it has done it, rather than ended; or raise its OutputError."""
        assert self.job is not None
        job, self.job = self.job, None
        try:
            answer = self.connection.poll() and self.connection.recv()
        except (EOFError, OSError):
            return job, False
        if isinstance(answer, MimocError):
            raise answer
        return job, answer

    @property
    def has_ended(self) -> bool:
        return self._process.poll() is not None

    def end(self) -> str:
        """End the process, and say how it ended if it has done so by itself."""
        self.connection.close()
        if self.job is None:
            with suppress(subprocess.TimeoutExpired):
                self._process.wait(PATIENCE_S)
        self._process.kill()
        self._process.communicate()
        code = self._process.returncode
        return f"the process was killed by signal {-code}" if code < 0 else f"the process ended with exit code {code}"


class Queue:
    """Jobs that wait to be done, by infant."""

    def __init__(self, jobs: Sequence[Job]):
        self._waiting: dict[str, deque[Job]] = {}
        for job in jobs:
            self.again(job)
        self._begun: dict[str, None] = {}
        """Infants that some process has built, in the order in which their first jobs were handed out."""

    def __bool__(self) -> bool:
        return bool(self._waiting)

    def again(self, job: Job) -> None:
        """Line up a job."""
        self._waiting.setdefault(job.infant, deque()).append(job)

    def next(self, infant: str) -> Job:
        """Return a job of an infant; if none is left, of one that is not begun; else of any."""
        if infant not in self._waiting:
            fresh = (other for other in self._waiting if other not in self._begun)
            infant = next(fresh, None) or max(self._waiting, key=lambda other: len(self._waiting[other]))
        self._begun[infant] = None
        job = self._waiting[infant].popleft()
        if not self._waiting[infant]:
            del self._waiting[infant]
        return job


def main(descriptor: int) -> None:
    """Do the jobs that come over a connection, and answer each with True, or with why the folder cannot be written."""
    os.set_inheritable(descriptor, False)
    lifeline = os.dup(0)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    Thread(target=_end_with, args=(lifeline,), daemon=True).start()
    connection = Connection(descriptor)
    with suppress(EOFError, ConnectionError):  # There are no more jobs, or nobody waits for the answer.
        while True:
            job, store = connection.recv()
            try:
                run_jobs([job], store)
            except MimocError as error:
                connection.send(error)
            else:
                connection.send(True)


def _end_with(lifeline: int) -> None:
    """End this process when the one that started it ends, however it ends."""
    while os.read(lifeline, 1):
        pass
    os._exit(1)


if __name__ == "__main__":
    main(int(sys.argv[1]))

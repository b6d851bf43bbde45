"""A thread that writes what is recorded, so that the simulation goes on meanwhile."""

from collections.abc import Callable
from queue import Queue
from threading import Thread

Job = Callable[[], None]
WAITING = 4
"""Jobs that wait at most; who brings another one waits as well, so that memory does not grow."""


class Writer:
    """Does jobs one after the other in a thread of its own; after one has failed, none is done any more.

    A forked process has no such thread, and writes nothing into the recording of the process that it comes from.
    """

    def __init__(self) -> None:
        self._jobs: Queue[Job | None] = Queue(WAITING)
        self._error: BaseException | None = None
        self._thread = Thread(target=self._work, name="mimoc recording", daemon=True)
        self._thread.start()

    def __call__(self, job: Job) -> None:
        """Have a job done, unless this process is a fork.

        Raises:
            MimocError: What one of the jobs before has raised.
        """
        self._check()
        if self._thread.is_alive():
            self._jobs.put(job)

    def drain(self) -> None:
        """Wait until all jobs are done.

        Raises:
            MimocError: What one of them has raised.
        """
        if self._thread.is_alive():
            self._jobs.join()
        self._check()

    def close(self) -> None:
        """Do what is left, and end the thread; closing twice is fine.

        Raises:
            MimocError: What one of the jobs has raised, unless it was raised before.
        """
        if self._thread.is_alive():
            self._jobs.put(None)
            self._thread.join()
        self._check()

    def _work(self) -> None:
        while (job := self._jobs.get()) is not None:
            if self._error is None:
                try:
                    job()
                except BaseException as error:
                    self._error = error
            self._jobs.task_done()

    def _check(self) -> None:
        if self._error is not None:
            raise self._error

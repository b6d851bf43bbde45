"""Jobs in processes on this machine."""

import os
from collections import Counter, deque
from collections.abc import Mapping, Sequence
from contextlib import suppress
from time import monotonic
from typing import Any

from mimoc.base.errors import MimocError
from mimoc.studies.cohorts.job import Job
from mimoc.studies.cohorts.run_jobs import PINNED, failed_result, run_jobs
from mimoc.studies.cohorts.store import Result, Store
from mimoc.studies.jobs import Worker, WorkerEndedError, ready

TRIES = 2  # How often a job is begun whose process is killed.


def run(jobs: Sequence[Job], store: Store, options: Mapping[str, Any], done: Any) -> None:
    """Do jobs in as many processes as this one may use cores, or as `processes` says.

    A job whose process is killed is begun again in another, and fails if that is killed as well.
    """
    number = min(options.get("processes") or len(os.sched_getaffinity(0)), len(jobs))
    queue, tries, finished = Queue(jobs), Counter[str](), 0
    infants, doing = dict[Worker, str](), dict[Worker, Job]()  # The infant that each process has built, and its job.
    try:
        while queue or doing:
            while queue and len(infants) < number:
                infants[Worker(PINNED)] = ""
            for worker, infant in infants.items():
                if queue and worker not in doing:
                    job = doing[worker] = queue.next(infant)
                    infants[worker] = job.infant
                    worker.begin(run_jobs, [job], store)
            for worker in ready(doing):
                job = doing.pop(worker)
                try:
                    worker.finish()
                except WorkerEndedError as ended:
                    del infants[worker]
                    tries[job.key] += 1
                    if tries[job.key] < TRIES:
                        queue.again(job)
                        continue
                    store.write(job, failed_result(job, f"{ended}, {TRIES} times; see the log"))
                finished += 1
                done(finished)
    finally:
        for worker in infants:
            worker.end()


def check(options: Mapping[str, Any]) -> None:
    """Check the number of processes; raise a MimocError if there would be none."""
    if (number := options.get("processes") or 1) < 1:
        raise MimocError(f"{number} processes can do nothing; give at least 1")


def try_out(jobs: Sequence[Job], store: Store, limit_s: float) -> list[Result | None]:
    """Do jobs one after the other in one process; return their results, None for those that a time limit stops."""
    worker, end_s = Worker(PINNED), monotonic() + limit_s
    try:
        with suppress(WorkerEndedError):
            for job in jobs:
                worker.begin(run_jobs, [job], store)
                worker.finish(within_s=max(end_s - monotonic(), 0.0))
    finally:
        worker.end()
    return [store.read(job) for job in jobs]


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

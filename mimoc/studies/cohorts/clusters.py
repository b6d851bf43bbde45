"""What engines that hand jobs to a cluster have in common.

A cluster does tasks: some jobs each, one after the other in one process, which may be killed.
"""

from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import groupby
from typing import Any, NamedTuple, Protocol

from mimoc.base.errors import MimocError
from mimoc.studies.cohorts.job import Job
from mimoc.studies.cohorts.run_jobs import failed_result
from mimoc.studies.cohorts.store import Store

Done = Callable[[int], None]  # Called with the number of jobs that have a result now.

Task = tuple[Job, ...]
TRIES = 2  # How often a job is begun whose task is killed, and how often a task is that ends before its first job.
LONG_STEPS = ("train", "experiment")  # Steps whose jobs are tasks of their own.
JOBS_PER_TASK = 50  # Jobs of the other steps in a task: a start of ten seconds is then 0.2 s a job.


class End(NamedTuple):
    """How a task has ended."""

    how: str
    on_purpose: bool = False  # Whether somebody has cancelled it, so that it is not to be done again.


class RefusedError(MimocError):
    """A cluster does not take tasks now."""


class Cluster(Protocol):
    """A cluster that does tasks."""

    @property
    def room(self) -> int:
        """Number of tasks that may wait or run there at once."""
        ...

    def submit(self, tasks: Sequence[Task]) -> Sequence[str]:
        """Begin tasks; return a name for each. Raise a RefusedError if the cluster does not take them."""
        ...

    def ended(self) -> Mapping[str, End]:
        """Wait a moment; return how tasks have ended that had not when this was called before."""
        ...

    def cancel(self) -> None:
        """End all tasks."""
        ...


def do_on(cluster: Cluster, tasks: Iterable[Task], store: Store, done: Done) -> None:
    """Have tasks done until each of their jobs has a result.

    A task that ends before its jobs are done is begun again with those that are left. A job fails that had begun when
    its task was killed, and had again the next time; all jobs of a task do that was cancelled.
    """
    waiting = deque(tasks)
    running = dict[str, Task]()
    finished = 0
    again = _Again(store)
    try:
        while waiting or running:
            free = cluster.room - len(running)
            if waiting and free >= min(len(waiting), cluster.room // 2):
                some = [waiting.popleft() for _ in range(min(free, len(waiting)))]
                try:
                    running.update(zip(cluster.submit(some), some, strict=True))
                except RefusedError:
                    if not running:
                        raise
                    waiting.extendleft(reversed(some))
            for name, end in cluster.ended().items():
                task = running.pop(name)
                if left := again.left(task, end):
                    waiting.append(left)
                finished += len(task) - len(left)
                done(finished)
    finally:
        if running:
            cluster.cancel()


def tasks_of(jobs: Sequence[Job], jobs_per_task: int | None) -> list[Task]:
    """Return tasks of neighbouring jobs, as many to a task as asked for; by default one if it takes long, else 50."""
    tasks: list[Task] = []
    for is_long, alike in groupby(jobs, lambda job: job.step in LONG_STEPS):
        some = tuple(alike)
        size = jobs_per_task or (1 if is_long else JOBS_PER_TASK)
        tasks += [some[start : start + size] for start in range(0, len(some), size)]
    return tasks


def check_positive(options: Mapping[str, Any]) -> None:
    """Check that all numbers among some options are above zero; raise a MimocError if one is not."""
    for name, value in options.items():
        if not isinstance(value, str) and value is not None and value <= 0:
            raise MimocError(f"{name}: {value} is too few; give a number above 0")


class _Again:
    """Decides which jobs are begun again."""

    def __init__(self, store: Store):
        self._store = store
        self._tries: Counter[tuple[str, bool]] = Counter()

    def left(self, task: Task, end: End) -> Task:
        """Return the jobs of a task that are to be begun again, after writing results of those that have failed."""
        left = tuple(self._store.missing(task))
        if not left:
            return left
        if end.on_purpose:
            return self._lost(left, left, end.how)
        begun = next((job for job in left if self._store.log(job).exists()), None)
        blamed = (begun or left[0]).key, begun is not None
        self._tries[blamed] += 1
        if self._tries[blamed] < TRIES:
            return left
        if begun:
            return self._lost([begun], left, f"{end.how}, {TRIES} times; see the log")
        return self._lost(left, left, f"{end.how} before its first job, {TRIES} times")

    def _lost(self, failed: Sequence[Job], left: Task, reason: str) -> Task:
        for job in failed:
            self._store.write(job, failed_result(job, reason))
        return tuple(job for job in left if job not in failed)

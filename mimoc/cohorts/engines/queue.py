"""Jobs that wait, of which each process gets those of the infant that it has built."""

from collections import deque
from collections.abc import Sequence

from mimoc.cohorts.job import Job


class Queue:
    """Jobs that wait to be done, by infant."""

    def __init__(self, jobs: Sequence[Job]):
        """Line up jobs in their order."""
        self._waiting: dict[str, deque[Job]] = {}
        for job in jobs:
            self.again(job)
        self._begun: dict[str, None] = {}
        """Infants that some process has built, in the order in which their first jobs were handed out."""

    def __bool__(self) -> bool:
        """Return whether any job waits."""
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

"""Jobs on a Ray cluster: one whose address is given, or a fresh one on this machine."""

import logging
import os
import socket
from collections.abc import Mapping, Sequence
from typing import Any

from mimoc.base.errors import MimocError, MissingExtraError
from mimoc.studies.cohorts.clusters import End, Task, check_positive, do_on, tasks_of
from mimoc.studies.cohorts.job import Job
from mimoc.studies.cohorts.run_jobs import PINNED, run_jobs
from mimoc.studies.cohorts.store import Store

try:
    import ray
except ImportError:
    raise MissingExtraError("ray", "ray") from None

LOCAL = "local"  # In place of an address: a cluster of this machine's own.
FOUND_BY_RAY = (LOCAL, "auto")  # What may stand in place of an address.
TASKS_PER_CORE = 4  # Tasks that wait or run at once, for each core of the cluster.
STARTS = 3
"""How often Ray is started on this machine until it works; a part of it gives up after 15 s, too soon for a busy
machine."""
ANSWER_S = 10.0  # How long to wait for an answer from an address.
POLL_S = 1.0  # How often to give the caller a chance.


def run(jobs: Sequence[Job], store: Store, options: Mapping[str, Any], done: Any) -> None:
    """Do jobs as tasks of one core each; a process that has joined a cluster uses that."""
    tasks = tasks_of(jobs, options.get("jobs_per_task"))
    shared = Store(store.folder.resolve())
    if ray.is_initialized():
        do_on(_Ray(shared), tasks, shared, done)
        return
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")  # What is started here tells nobody.
    if (address := _address(options)) == LOCAL:
        _start()
    elif problem := _problem(address):
        raise _no_cluster(address, problem)
    try:
        do_on(_Ray(shared), tasks, shared, done)
    finally:
        ray.shutdown()


def check(options: Mapping[str, Any]) -> None:
    """Check that numbers are positive, and that something answers at the address; raise a MimocError if not."""
    check_positive(options)
    address = _address(options)
    if address in FOUND_BY_RAY:
        return
    host, _, port = address.removeprefix("ray://").rpartition(":")
    if not (host and port.isdigit()):
        raise _no_cluster(address, "an address is HOST:PORT")
    try:  # Ray itself waits for minutes for what does not answer.
        socket.create_connection((host, int(port)), ANSWER_S).close()
    except (OSError, OverflowError) as error:
        raise _no_cluster(address, str(error)) from None


def _address(options: Mapping[str, Any]) -> str:
    return options.get("address") or os.environ.get("RAY_ADDRESS") or LOCAL


def _no_cluster(address: str, problem: str) -> MimocError:
    return MimocError(
        f"there is no Ray cluster at '{address}' ({problem}); give the address that 'ray start --head' prints"
    )


def _start() -> None:
    for tries_left in reversed(range(STARTS)):
        problem = _problem(LOCAL, num_cpus=len(os.sched_getaffinity(0)), include_dashboard=False)
        if problem is None:
            return
        if not tries_left:
            raise MimocError(f"Ray does not start on this machine ({problem}); try again, or give an address")


def _problem(address: str, **options: Any) -> str | None:
    try:
        ray.init(address=address, logging_level=logging.ERROR, log_to_driver=False, **options)
    except Exception as error:  # Ray raises just that if a node does not start in time.
        ray.shutdown()
        return str(error).strip().partition("\n")[0]
    return None


class _Ray:
    """Tasks that a Ray cluster does."""

    def __init__(self, store: Store):
        self._store, self._running = store, dict[str, ray.ObjectRef]()
        pinned = {"env_vars": dict(PINNED)}
        self._do = ray.remote(num_cpus=1, max_retries=0, runtime_env=pinned)(run_jobs)

    @property
    def room(self) -> int:
        return TASKS_PER_CORE * max(1, int(ray.cluster_resources().get("CPU", 1)))

    def submit(self, tasks: Sequence[Task]) -> Sequence[str]:
        begun = [self._do.remote(task, self._store) for task in tasks]
        names = [task.hex() for task in begun]
        self._running.update(zip(names, begun, strict=True))
        return names

    def ended(self) -> Mapping[str, End]:
        ready, _ = ray.wait([*self._running.values()], num_returns=1, timeout=POLL_S)
        if ready:
            ready, _ = ray.wait([*self._running.values()], num_returns=len(self._running), timeout=0)
        return {task.hex(): _end(self._running.pop(task.hex())) for task in ready}

    def cancel(self) -> None:
        for task in self._running.values():
            ray.cancel(task, force=True)


def _end(task: "ray.ObjectRef") -> End:
    try:
        ray.get(task)
    except Exception as error:
        reason = str(error).strip().partition("\n")[0]
        return End(f"Ray has lost the task ({type(error).__name__}: {reason})")
    return End("the task has ended")

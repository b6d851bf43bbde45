"""Jobs on a SLURM cluster, as array tasks that submitit submits from a machine that has `sbatch`."""

import shutil
import signal
import subprocess
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import monotonic, sleep
from typing import Any

from mimoc.base.errors import MimocError, MissingExtraError
from mimoc.bundle.files import make_folder
from mimoc.studies.cohorts.clusters import End, RefusedError, Task, check_positive, do_on, tasks_of
from mimoc.studies.cohorts.job import Job
from mimoc.studies.cohorts.run_jobs import PINNED, run_jobs
from mimoc.studies.cohorts.store import Store

try:
    import submitit
except ImportError:
    raise MissingExtraError("submitit", "slurm") from None

TIME_MIN = 60  # Time that a task may take unless said otherwise.
ARRAY = 1000  # Most tasks of an array, since SLURM's own limit is 1001 unless an administrator has changed it.
ENDED = {  # SLURM's states of tasks that will not run again.
    *("BOOT_FAIL", "CANCELLED", "COMPLETED", "DEADLINE", "FAILED", "NODE_FAIL"),
    *("OUT_OF_MEMORY", "PREEMPTED", "REVOKED", "TIMEOUT"),
}
POLLS_S = (1.0, 15.0)
"""How long to wait before asking for the states of tasks: at first, and after a while in which none has ended."""
PATIENCE_S = 1800.0  # How long to wait for a controller that does not answer.


def run(jobs: Sequence[Job], store: Store, options: Mapping[str, Any], done: Any) -> None:
    """Do jobs as tasks of arrays; raise a MimocError if SLURM refuses them, or does not answer for long."""
    shared = Store(store.folder.resolve())
    tasks = tasks_of(jobs, options.get("jobs_per_task"))
    folder = Path(tempfile.mkdtemp(prefix="run-", dir=make_folder(shared.folder / "slurm", below=shared.folder)))
    try:
        do_on(_Slurm(shared, folder, options), tasks, shared, done)
    except RefusedError:
        shutil.rmtree(folder)
        raise
    if all((result := shared.read(job)) and result.ok for job in jobs):
        shutil.rmtree(folder)


def check(options: Mapping[str, Any]) -> None:
    """Check that SLURM is here, and that numbers are positive; raise a MimocError if not."""
    check_positive(options)
    if missing := [name for name in ("sbatch", "squeue", "scancel") if not shutil.which(name)]:
        raise MimocError(f"there is no SLURM here: no command '{missing[0]}'; run this where SLURM jobs are submitted")


class _Slurm:
    """Tasks in SLURM's queue."""

    room = ARRAY

    def __init__(self, store: Store, folder: Path, options: Mapping[str, Any]):
        self._store = store
        self._running = set[str]()
        self._poll_s = POLLS_S[0]
        self._executor = submitit.SlurmExecutor(folder=folder)
        asked = {
            "partition": options.get("partition"),
            "time": options.get("time_min") or TIME_MIN,
            "mem_gb": options.get("memory_gb"),
            "array_parallelism": options.get("array_limit") or ARRAY,
            "setup": [f"export {name}={value}" for name, value in PINNED.items()],
        }
        given = {name: value for name, value in asked.items() if value is not None}
        self._executor.update_parameters(
            job_name="mimoc", cpus_per_task=1, stderr_to_stdout=True, use_srun=False, signal_delay_s=1, **given
        )

    def submit(self, tasks: Sequence[Task]) -> Sequence[str]:
        try:
            submitted = self._executor.map_array(_do, tasks, [self._store] * len(tasks))
        except submitit.core.utils.FailedJobError as error:
            lines = [line.strip() for line in str(error).splitlines() if line.strip()]
            last = lines[-1] if lines else "sbatch failed"
            reason = next((line for line in lines if "error" in line.lower()), last)
            raise RefusedError(f"SLURM refuses the tasks: {reason}") from None
        names = [job.job_id for job in submitted]
        self._running.update(names)
        self._poll_s = POLLS_S[0]
        return names

    def ended(self) -> Mapping[str, End]:
        sleep(self._poll_s)
        self._poll_s = min(1.5 * self._poll_s, POLLS_S[1])
        states = _states()
        ends = {}
        for name in self._running:
            state = states.get(name, "unknown")
            if state in ENDED or name not in states:
                how = f"task {name} was ended by SLURM (state {state})"
                ends[name] = End(how, on_purpose=state == "CANCELLED")
        self._running -= ends.keys()
        return ends

    def cancel(self) -> None:
        arrays = {name.partition("_")[0] for name in self._running}
        subprocess.run(["scancel", *sorted(arrays)], capture_output=True, check=False)


def _do(task: Task, store: Store) -> None:
    """Do the jobs of a task, in a process that SLURM has started."""
    for number in (signal.SIGUSR2, signal.SIGTERM):  # submitit would raise an error in the job instead of ending.
        signal.signal(number, signal.SIG_DFL)
    run_jobs(task, store)


def _states() -> dict[str, str]:
    """Return SLURM's states of all tasks of this user, of those that have ended some minutes ago none."""
    end_s = monotonic() + PATIENCE_S
    while True:
        squeue = ["squeue", "--me", "--noheader", "--array", "--states=all", "--format=%i %T"]
        answer = subprocess.run(squeue, capture_output=True, text=True, check=False)
        if answer.returncode == 0:
            return dict(line.split(maxsplit=1) for line in answer.stdout.splitlines() if " " in line.strip())
        if monotonic() > end_s:
            raise MimocError(f"SLURM does not answer: {answer.stderr.strip()}; run the same command again when it does")
        sleep(POLLS_S[1])

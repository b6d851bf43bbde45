"""Doing jobs in this process: each leaves a result, whatever happens to it.

This is all that an engine needs: it hands jobs and the folder to `run_jobs` on some machine that shares the folder.
"""

import os
import platform
import sys
import traceback
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import perf_counter

from mimoc.base.errors import MimocError
from mimoc.bundle.files import open_new_file, write_error
from mimoc.studies.cohorts.job import Job
from mimoc.studies.cohorts.store import Result, Store
from mimoc.studies.cohorts.work import JobContext, measured
from mimoc.version import __version__

PINNED: Mapping[str, str] = {
    **{f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL", "NUMEXPR", "BLIS")},
    "VECLIB_MAXIMUM_THREADS": "1",
}
"""Environment variables of a process that does jobs: one thread, since there are as many processes as cores."""

LIBRARIES = {"": ("mujoco", "numpy"), "train": ("torch", "stable_baselines3", "gymnasium")}
"""Libraries whose versions a result names: those of every step, and those of single ones."""


def run_jobs(jobs: Sequence[Job], store: Store) -> None:
    """Do jobs one after the other, and write the result of each.

    Jobs of one infant stand next to each other, since the last infant is kept. Those that have a result are left out,
    so that jobs can be handed out twice.
    """
    for job in store.missing(jobs):
        store.write(job, run_job(job, store))


def run_job(job: Job, store: Store) -> Result:
    """Do a job and return its result, also if it fails."""
    start = perf_counter()
    with _logged(store.log(job), store.folder):
        try:
            measures = dict(measured(JobContext(job, store)))
        except KeyboardInterrupt:
            raise
        except BaseException as error:  # Also SystemExit: a user's function must not end the process.
            traceback.print_exc()
            reason = "; ".join(str(error).split("\n")).strip()
            if not (isinstance(error, MimocError) and reason):
                reason = f"{type(error).__name__}: {reason}".rstrip(": ")
            return Result("failed", {}, _versions(job.step), reason, perf_counter() - start)
    with suppress(OSError):
        if not store.log(job).stat().st_size:
            store.log(job).unlink()
    return Result("ok", measures, _versions(job.step), seconds=perf_counter() - start)


def failed_result(job: Job, reason: str) -> Result:
    """Return the result of a job whose process ended without one."""
    return Result("failed", {}, _versions(job.step), reason)


@contextmanager
def _logged(path: Path, folder: Path) -> Iterator[None]:
    """Write to a file below a folder all that this process prints, by Python or by a library beneath it."""
    _flush()
    log = open_new_file(path, below=folder)
    kept = [os.dup(number) for number in (1, 2)]
    try:
        os.dup2(log, 1)
        os.dup2(log, 2)
        with (
            open(log, "w", encoding="utf-8", errors="backslashreplace", closefd=False) as text,
            redirect_stdout(text),
            redirect_stderr(text),
        ):
            yield
    except OSError as error:  # No job raises one here: what is printed cannot be written.
        raise write_error(path, error) from None
    finally:
        _flush()
        for number, before in zip((1, 2), kept, strict=True):
            os.dup2(before, number)
            os.close(before)
        os.close(log)


def _flush() -> None:
    for stream in (sys.stdout, sys.stderr):
        with suppress(Exception):
            stream.flush()


def _versions(step: str) -> dict[str, str]:
    software = {"mimoc": __version__, "python": platform.python_version()}
    for library in (*LIBRARIES[""], *LIBRARIES.get(step, ())):
        with suppress(PackageNotFoundError):
            software[library] = version(library)
    return software

"""The jobs whose results are in the folder of a cohort, for those who do not have its file."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mimoc.cohorts.job import Job
from mimoc.cohorts.store import Store

STEPS = ("build", "check", "run", "train", "experiment", "python")


def kept_jobs(store: Store) -> tuple[tuple[Job, ...], tuple[Path, ...]]:
    """Return the jobs that have a result, by step, factors and seed, and the results that cannot be read.

    The jobs do not know the specs of their infants, so that they can be told of, but not be done again.

    Raises:
        MimocError: If the folder is not that of a cohort.
    """
    store.check()
    jobs, damaged = [], []
    for path in sorted((store.folder / "results").glob("*/*.json")):
        try:
            jobs.append(_job(json.loads(path.read_bytes()), path.stem))
        except (OSError, ValueError, KeyError, TypeError):
            damaged.append(path)
    readable = [job for job in jobs if store.read(job) is not None]
    damaged += [store.result(job) for job in jobs if job not in readable]
    return tuple(sorted(readable, key=_place)), tuple(damaged)


def _job(told: Mapping[str, Any], key: str) -> Job:
    if told["job"] != key or not isinstance(told["factors"], dict) or not isinstance(told["options"], dict):
        raise ValueError("not the result of this job")
    return Job(
        key=key,
        cohort=str(told["cohort"]),
        factors=told["factors"],
        step=str(told["step"]),
        options=told["options"],
        seed=told["seed"],
        data=None,
        folder="",
        spec_folder="",
        own_measures=(),
    )


def _place(job: Job) -> tuple[Any, ...]:
    """Return what jobs are sorted by."""
    step = STEPS.index(job.step) if job.step in STEPS else len(STEPS)
    factors = tuple((name, _order(value)) for name, value in sorted(job.factors.items()))
    return step, job.step, factors, _order(job.seed), job.key


def _order(value: Any) -> tuple[int, float, str]:
    """Return what values of any kind are sorted by: numbers first."""
    if isinstance(value, (int, float)):
        return 0, float(value), ""
    return 1, 0.0, json.dumps(value, sort_keys=True)

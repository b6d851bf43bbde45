"""The jobs whose results are in the folder of a cohort, for those who do not have its file."""

import json
import re
from collections.abc import Iterator
from pathlib import PurePosixPath
from typing import Any

from mimoc.bundle.json_files import parse_json
from mimoc.bundle.regular_files import RegularFiles, UnusableFileError, regular_files
from mimoc.cohorts.job import Job
from mimoc.cohorts.store import RESULTS, Store
from mimoc.schema.cohort_folder import MOST_BYTES, ResultFile

STEPS = ("build", "check", "run", "train", "experiment", "python")
MOST_BYTES_IN_ALL = 2**30
"""Of all results; 1 GB. Those of a million jobs have less."""
_FOLDER, _FILE = re.compile("[0-9a-f]{2}"), re.compile(r"[^.].*\.json")
"""Names of folders of results, and of results; of those that are being written they begin with a dot."""


def kept_jobs(store: Store) -> tuple[tuple[Job, ...], tuple[str, ...]]:
    """Return the jobs that have a result, by step, factors and seed, and the names of results that cannot be read.

    The jobs do not know the specs of their infants, so that they can be told of, but not be done again.

    Raises:
        MimocError: If the folder is not that of a cohort.
    """
    store.check()
    jobs, damaged = list[Job](), list[str]()
    with regular_files(store.folder, MOST_BYTES_IN_ALL) as files:
        for path in _results(files):
            try:
                jobs.append(_job(files, path))
            except UnusableFileError:
                damaged.append(path.name)
    return tuple(sorted(jobs, key=_place)), tuple(damaged)


def _results(files: RegularFiles) -> Iterator[PurePosixPath]:
    """Yield the paths of all results, and those of folders that are none or links, which cannot be read."""
    results = PurePosixPath(RESULTS)
    folders = [results / name for name in _names(files, results) or () if _FOLDER.fullmatch(name)]
    for folder in folders or [results]:
        names = _names(files, folder)
        yield from [folder] if names is None else (folder / name for name in names if _FILE.fullmatch(name))


def _names(files: RegularFiles, folder: PurePosixPath) -> list[str] | None:
    """Return what is in a folder; None if it is a link, or not a folder."""
    try:
        return files.names(folder.as_posix())
    except UnusableFileError:
        return None


def _job(files: RegularFiles, path: PurePosixPath) -> Job:
    """Return the job in the file of a result; raise an UnusableFileError if it is in none."""
    file = parse_json(files.read(path.as_posix(), MOST_BYTES) or b"", ResultFile)
    if path != PurePosixPath(RESULTS, file.job[:2], f"{file.job}.json"):
        raise UnusableFileError("is the result of another job")
    known = {name: getattr(file, name) for name in ("cohort", "step", "seed", "options", "factors")}
    return Job(key=file.job, **known, data=None, folder="", spec_folder="", own_measures=())


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

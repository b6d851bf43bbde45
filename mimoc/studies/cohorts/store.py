"""The folder of a cohort, which all processes and machines that work on it share."""

import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from mimoc.base.errors import BundleError, MimocError, OutputError
from mimoc.base.rounding import render_json, rounded
from mimoc.bundle.files import SharedFiles, check_unlinked, make_folder, remove, write_error, write_file
from mimoc.bundle.io import Bundle, read_bundle, without, write_bundle
from mimoc.bundle.regular_files import RegularFiles, UnusableFileError, parse_json, read_json_file, regular_files
from mimoc.schema.cohort_file import MAX_BYTES, MarkFile, ResultFile
from mimoc.studies.cohorts.job import Job

MARK = "cohort.json"  # File that says that a folder is a cohort's.
RESULTS, ASSETS = "results", "assets"
FOLDERS = (RESULTS, "logs", "bundles", "runs", ASSETS)
PROVENANCE = "provenance.json"
"""Half of a bundle, and different for each infant: it is left out, and `mimoc explain` works it out again."""


@dataclass(frozen=True, slots=True)
class Result:
    """The result of a job."""

    status: str  # `ok` or `failed`.
    measures: Mapping[str, Any]
    versions: Mapping[str, str]  # Versions of the software that did it.
    error: str = ""  # What went wrong, in one line.
    seconds: float = 0.0  # Wall time that it took.

    @property
    def ok(self) -> bool:
        """Whether the job succeeded."""
        return self.status == "ok"


@dataclass(frozen=True, slots=True)
class Store:
    """The folder of a cohort: a result for each job that is done, whole or absent."""

    folder: Path

    def create(self, cohort: str) -> None:
        """Make the folder, unless it exists; raise an OutputError if it holds anything else, or cannot be written."""
        self.check_usable()
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except FileExistsError as error:
            raise OutputError(f"{error.filename}: this is a file; name a new folder") from None
        except OSError as error:
            raise OutputError(f"{self.folder}: cannot be written ({error.strerror}); choose another folder") from None
        write_file(self.folder / MARK, render_json({"cohort": cohort, "version": 1}))
        for name in FOLDERS:
            make_folder(self.folder / name, below=self.folder)

    def check_usable(self) -> None:
        """Check that this folder does not exist, is empty, or is a cohort's; raise a MimocError if it is not."""
        if self.folder.exists() and not self.folder.is_dir():
            raise OutputError(f"{self.folder}: this is a file; name a new folder")
        try:
            inside = [*self.folder.iterdir()] if self.folder.is_dir() else []
        except OSError as error:
            raise OutputError(f"{self.folder}: cannot be read ({error.strerror}); choose another folder") from None
        if any(not path.name.startswith(".") for path in inside) and not self._is_marked():
            raise OutputError(f"{self.folder}: not the folder of a cohort; name a new or empty folder")

    def check(self) -> None:
        """Check that this is the folder of a cohort; raise a MimocError if it is not."""
        if not self._is_marked():
            raise MimocError(f"{self.folder}: not the folder of a cohort; name the one given to 'mimoc cohort run -o'")

    def _is_marked(self) -> bool:
        try:
            return read_json_file(self.folder / MARK, MarkFile) is not None
        except UnusableFileError as error:
            raise MimocError(f"{self.folder / MARK}: {error}; this is not the folder of a cohort") from None

    def read(self, job: Job) -> Result | None:
        """Return the result of a job; None if it is not done, or its file is damaged, so that it is done again."""
        try:
            file = read_json_file(self.result(job), ResultFile, MAX_BYTES, below=self.folder)
        except UnusableFileError:
            return None
        if file is None or file.job != job.key:
            return None
        return Result(**{name: getattr(file, name) for name in Result.__slots__})

    def result(self, job: Job) -> Path:
        """Return the path of the result of a job."""
        return self._place(RESULTS, job, ".json")

    def missing(self, jobs: Iterable[Job]) -> list[Job]:
        """Return the jobs without a result."""
        return [job for job in jobs if self.read(job) is None]

    def write(self, job: Job, result: Result) -> None:
        """Write the result of a job; a failure never replaces a success, which another process may have had."""
        if not result.ok and (known := self.read(job)) and known.ok:
            return
        place = self.result(job)
        make_folder(place.parent, below=self.folder)
        of_job = {name: getattr(job, name) for name in ("cohort", "step", "seed", "options", "factors")}
        of_result = {name: getattr(result, name) for name in Result.__slots__}
        write_file(place, render_json(_plain({"job": job.key, **of_job, **of_result})), below=self.folder)

    def forget(self, job: Job) -> None:
        """Remove the result of a job, so that it is done again; raise an OutputError if it cannot be removed."""
        for path in (self.result(job), self.log(job)):
            check_unlinked(path.parent, below=self.folder)
            try:
                path.unlink(missing_ok=True)
            except OSError as error:
                raise write_error(path, error) from None

    def log(self, job: Job) -> Path:
        """Return the path of what a job prints."""
        return self._place("logs", job, ".txt")

    def runs(self, job: Job, *, empty: bool = False) -> Path:
        """Return the folder of what else a job writes, such as a training run; *empty* to begin with an empty one."""
        folder = check_unlinked(self._place("runs", job, ""), below=self.folder)
        if empty:
            remove(folder)
        return make_folder(folder, below=self.folder)

    def bundle_folder(self, job: Job) -> Path:
        """Return the folder of a bundle that a job builds."""
        return self._place("bundles", job, "")

    def write_bundle(self, job: Job, bundle: Bundle) -> Path:
        """Write a bundle, without its provenance, that shares pictures and meshes with all others."""
        folder = check_unlinked(self.bundle_folder(job), below=self.folder)
        lean = without(bundle, PROVENANCE)
        check_unlinked(self.folder / ASSETS, below=self.folder)
        return write_bundle(lean, folder, force=True, shared=SharedFiles(self.folder / ASSETS))

    def read_bundle(self, job: Job) -> Bundle:
        """Return the bundle that a job has built; raise a BundleError if there is none."""
        try:
            return read_bundle(check_unlinked(self.bundle_folder(job), below=self.folder))
        except OutputError as error:
            raise BundleError(str(error)) from None

    def _place(self, kind: str, job: Job, suffix: str) -> Path:
        return self.folder / kind / job.key[:2] / f"{job.key}{suffix}"


def _plain(data: Any) -> Any:
    """Return data with numbers as they are in files, without what neither JSON nor UTF-8 knows."""
    if isinstance(data, str):
        return data.encode(errors="backslashreplace").decode()
    if isinstance(data, Mapping):
        return {_plain(key): _plain(value) for key, value in data.items()}
    if isinstance(data, (list, tuple)):
        return [_plain(value) for value in data]
    if isinstance(data, float):
        return rounded(data) if data - data == 0 else None
    return data


def size_bytes(folder: Path) -> int:
    """Return the size of all files below a folder, each counted once however many links it has."""
    sizes = {}
    for path, _, names in os.walk(folder):
        for name in names:
            status = os.lstat(os.path.join(path, name))
            sizes[status.st_dev, status.st_ino] = status.st_size
    return sum(sizes.values())


STEPS = ("build", "check", "run", "train", "experiment", "python")
MAX_BYTES_IN_ALL = 2**30  # Largest size of all results together, 1 GB; those of a million jobs are smaller.
_FOLDER, _FILE = re.compile("[0-9a-f]{2}"), re.compile(r"[^.].*\.json")
"""Names of folders of results, and of results; of those that are being written they begin with a dot."""


def finished_jobs(store: Store) -> tuple[tuple[Job, ...], tuple[str, ...]]:
    """Return the jobs that have a result, by step, factors and seed, and the names of results that cannot be read.

    They do not know the specs of their infants, so that they cannot be done again. Another folder is a MimocError.
    """
    store.check()
    jobs, damaged = list[Job](), list[str]()
    with regular_files(store.folder, MAX_BYTES_IN_ALL) as files:
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
    try:
        return files.names(folder.as_posix())
    except UnusableFileError:
        return None


def _job(files: RegularFiles, path: PurePosixPath) -> Job:
    file = parse_json(files.read(path.as_posix(), MAX_BYTES) or b"", ResultFile)
    if path != PurePosixPath(RESULTS, file.job[:2], f"{file.job}.json"):
        raise UnusableFileError("is the result of another job")
    known = {name: getattr(file, name) for name in ("cohort", "step", "seed", "options", "factors")}
    return Job(key=file.job, **known, data=None, folder="", spec_folder="", own_measures=())


def _place(job: Job) -> tuple[Any, ...]:
    step = STEPS.index(job.step) if job.step in STEPS else len(STEPS)
    factors = tuple((name, _order(value)) for name, value in sorted(job.factors.items()))
    return step, job.step, factors, _order(job.seed), job.key


def _order(value: Any) -> tuple[int, float, str]:
    """Return what values of any kind are sorted by: numbers first."""
    if isinstance(value, (int, float)):
        return 0, float(value), ""
    return 1, 0.0, json.dumps(value, sort_keys=True)

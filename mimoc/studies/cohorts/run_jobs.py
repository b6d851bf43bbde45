"""Doing jobs in this process: what each step does and measures, and a result whatever happens.

This is all that an engine needs: it hands jobs and the folder to `run_jobs` on some machine that shares the folder.
"""

import json
import os
import platform
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager, redirect_stderr, redirect_stdout, suppress
from dataclasses import asdict, dataclass, field
from functools import cached_property, lru_cache, partial
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import perf_counter
from typing import Any

from mimoc.base.errors import MimocError
from mimoc.base.quantities import MILESTONE_AGES, measured_in
from mimoc.bundle.files import check_unlinked, open_new_file, write_error
from mimoc.bundle.io import LOCK, Bundle
from mimoc.compiler.building import builder, sees_skin
from mimoc.policies.named import policy_of
from mimoc.policies.policy import PolicyMaker
from mimoc.policies.rollout import Run
from mimoc.runtime.check import check_stability
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.quantities import measure
from mimoc.schema.infant import InfantSpec, read_spec
from mimoc.schema.source import in_memory_as_text
from mimoc.studies.cohorts.job import Job, import_function
from mimoc.studies.cohorts.store import Result, Store
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


@dataclass(frozen=True)
class JobContext:
    """A job that is being done; functions of the user's own are called with it."""

    job: Job
    store: Store
    measures: dict[str, Any] = field(default_factory=dict)  # What has been measured so far, by name.

    @property
    def seed(self) -> int:
        """Seed of the job; 0 for a step without seeds."""
        return self.job.seed or 0

    @property
    def factors(self) -> Mapping[str, Any]:
        """What tells its infant from the others of the cohort: child, age and so on."""
        return self.job.factors

    @property
    def spec(self) -> InfantSpec:
        """The spec of the infant."""
        return _spec(*self._origin)

    @property
    def bundle(self) -> Bundle:
        """The infant; it is built when first asked for."""
        return _bundle(*self._origin)

    @cached_property
    def folder(self) -> Path:
        """An empty folder for files of this job, which are kept."""
        return self.store.runs(self.job, empty=True)

    @property
    def _origin(self) -> tuple[str, str, str]:
        """The spec of its infant as JSON, the name of the cohort, and the folder that paths in the spec start from."""
        return json.dumps(self.job.data or {}, default=dict), self.job.cohort, self.job.spec_folder


@lru_cache(maxsize=1)  # The jobs of one infant come one after the other.
def _spec(infant: str, cohort: str, folder: str) -> InfantSpec:
    return read_spec(in_memory_as_text(json.loads(infant), f"<{cohort}>", Path(folder)))


@lru_cache(maxsize=1)
def _bundle(infant: str, cohort: str, folder: str) -> Bundle:
    spec = _spec(infant, cohort, folder)
    return builder(spec, skin=sees_skin(spec))(spec.scene.seed)


Measures = Mapping[str, Any]


def measure_child(work: JobContext) -> Measures:
    """Return the measures of an infant that a step has whatever it does."""
    return measure("child", work.job.step, [work.bundle.manifest.child])


def build(work: JobContext) -> Measures:
    """Build the infant, and keep its bundle."""
    bundle = work.bundle
    work.store.write_bundle(work.job, bundle)
    return {**measure_child(work), "bundle": f"sha256:{sha256(bundle.files[LOCK]).hexdigest()}"}


def check(work: JobContext) -> Measures:
    """Check that the infant stays stable from every pose."""
    checks = [*check_stability(work.bundle)]
    return {**measure_child(work), **measure("pose", "check", checks)}


def milestones(work: JobContext) -> Measures:
    """Find the ages from which on the child reaches motor milestones."""
    from mimoc.studies.milestones.search import search_near
    from mimoc.studies.milestones.trial import Conditions

    conditions = Conditions(delays=work.job.options["delays"])
    options = work.job.options
    ages = {name: search_near(work.spec, conditions, name).youngest_months for name in options["trials"]}
    return {**measure_child(work), **{MILESTONE_AGES[name].name: age for name, age in ages.items()}}


def run(work: JobContext) -> Measures:
    """Run the infant under a policy."""
    options = work.job.options
    with closing(InfantEnv(work.bundle)) as env, ExitStack() as recorded:
        if options.get("record"):
            from mimoc.recording.recorder import Recording

            recorded.enter_context(Recording([env], work.folder / "recording"))
        load = partial(_load_trained, folder=work.job.folder)
        rollout = Run(env, partial(policy_of, policy=options["policy"], load=load), work.seed)
        for _ in range(options["steps"]):
            rollout.step()
        summary = rollout.summary()
    movement: Measures = {}
    if options.get("record"):
        from mimoc.recording.measures import mean_measures

        movement = mean_measures(work.folder / "recording", "run")
    return {**measure_child(work), **summary.measures, **movement, **summary.metrics}


def train(work: JobContext) -> Measures:
    """Train a policy; a training that was killed is resumed."""
    from mimoc.training import train as learn

    folder = check_unlinked(work.store.runs(work.job) / "training", below=work.store.folder)
    origin = {"cohort": work.job.cohort, "job": work.job.key, "factors": dict(work.job.factors)}
    training = learn(work.bundle, folder, seed=work.seed, threads=1, origin=origin, **work.job.options)
    last = asdict(training.curve.ends[1]) if training.curve.rows else {}
    learnt = {item.name: last.get(item.curve) for item in measured_in("train") if item.curve}
    return {**measure_child(work), **learnt}


def experiment(work: JobContext) -> Measures:
    """Run one of mimoc's experiments; its tables and its page are kept."""
    from mimoc.studies.experiment import run_experiment

    options = work.job.options
    run_experiment(options["name"], work.folder, quick=options["quick"], development=options["development"])
    return {}


def python(work: JobContext) -> Measures:
    """Call a function of the user's own, which returns measures by name, or nothing."""
    options = work.job.options
    function = import_function(options["function"], work.job.folder)
    returned = function(work, **options["options"])
    if returned is not None and not isinstance(returned, Mapping):
        raise MimocError(f"'{options['function']}' returned {type(returned).__name__}; return a dictionary of measures")
    named = {str(name): _cell(value, options["function"]) for name, value in (returned or {}).items()}
    return {**measure_child(work), **named}


STEPS: Mapping[str, Callable[[JobContext], Measures]] = {
    step.__name__: step for step in (build, check, milestones, run, train, experiment, python)
}


def measured(work: JobContext) -> Measures:
    """Do a job, and return all that it measures; raise a MimocError if it cannot be done."""
    work.measures.update(STEPS[work.job.step](work))
    for name in work.job.own_measures:
        work.measures[name] = _cell(import_function(name, work.job.folder)(work), name)
    return work.measures


def _load_trained(path: str, folder: str) -> PolicyMaker:
    """Return the trained policy in a file; its path is relative to the folder of the cohort file."""
    from mimoc.training import load_policy

    return load_policy(Path(folder) / path)


def _cell(value: Any, function: str) -> str | bool | int | float | None:
    """Return a value for the table: NumPy's numbers as Python's; a MimocError says which value has no place there."""
    plain = value.item() if getattr(value, "shape", None) == () else value
    if plain is not None and not isinstance(plain, (str, bool, int, float)):
        raise MimocError(f"'{function}' measured a {type(plain).__name__}; return a number, a text or None")
    if isinstance(plain, int) and plain.bit_length() > 63:
        raise MimocError(f"'{function}' measured a whole number of more than 64 bits; return it as a float")
    return plain

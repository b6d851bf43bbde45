"""A job: one step with one infant and one seed, named by the hash of all it does, and functions of a user."""

import json
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import sha256
from importlib import import_module, invalidate_caches
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from mimoc.base.errors import MimocError
from mimoc.base.quantities import QUANTITIES, measured_in, measures
from mimoc.base.rounding import rounded
from mimoc.policies.spec import trained_policies
from mimoc.schema.cohort_file import CohortSpec, step_of
from mimoc.schema.infant import to_data
from mimoc.studies.cohorts.infants import CohortInfant
from mimoc.version import __version__

WITHOUT_INFANT = ("experiment",)  # Steps that bring their own infants.
MAX_JOBS = 1_000_000


@dataclass(frozen=True, slots=True)
class Job:
    """One step with one infant and one seed, as plain data that any process can be handed."""

    key: str  # Hash of all that determines the result.
    cohort: str  # Name of the cohort.
    factors: Mapping[str, Any]  # What tells its infant from the others.
    step: str
    options: Mapping[str, Any]  # Options of the step.
    seed: int | None
    data: Mapping[str, Any] | None  # The spec of its infant; None for a step that brings its own infants.
    folder: str  # Folder of the cohort file, where modules and policies are.
    spec_folder: str  # Folder that paths in the spec are relative to.
    own_measures: tuple[str, ...]  # Functions of the user's own that measure, as `module:function`.

    @property
    def infant(self) -> str:
        """What jobs with the same infant have in common."""
        return "" if self.data is None else _text(self.data)


def jobs_of(cohort: CohortSpec, infants: Sequence[CohortInfant], folder: Path, spec_folder: Path) -> tuple[Job, ...]:
    """Return all jobs, those of one infant next to each other and equal ones once; a MimocError says what they lack."""
    place, home = str(folder.resolve()), str(spec_folder.resolve())
    functions_named = tuple(name for name in cohort.measure if name not in measures())
    steps = [*_steps(cohort)]
    if (number := len(infants) * len(steps)) > MAX_JOBS:
        raise MimocError(f"{number:,} jobs are more than {MAX_JOBS:,}; split the cohort into several files")
    functions = {*functions_named, *(options["function"] for step, options, _ in steps if step == "python")}
    policies = {path for step, options, _ in steps if step == "run" for path in trained_policies(options["policy"])}
    code = {name: digest_of(name, place) for name in functions}
    code |= {name: _policy_digest(Path(place) / name) for name in policies}
    jobs: dict[str, Job] = {}
    for infant in infants:
        resolved = rounded(to_data(infant.spec))
        for step, options, seed in steps:
            alone = step in WITHOUT_INFANT
            trained = trained_policies(options["policy"]) if step == "run" else ()
            used = {*functions_named, options.get("function"), *trained} & code.keys()
            what = {
                "mimoc": __version__,
                "spec": None if alone else resolved,
                "step": step,
                "options": options,
                "seed": seed,
                "measure": (*functions_named, *_added_measures(step)),
                "code": {name: code[name] for name in sorted(used)},
            }
            key = sha256(_text(what).encode()).hexdigest()[:32]
            factors, data = ({}, None) if alone else (infant.factors, infant.data)
            job = Job(key, cohort.cohort, factors, step, options, seed, data, place, home, functions_named)
            jobs.setdefault(key, job)
    return tuple(jobs.values())


def _steps(cohort: CohortSpec) -> Iterator[tuple[str, dict[str, Any], int | None]]:
    for item in cohort.do:
        name, chosen = step_of(item)
        options = chosen.model_dump(mode="json")
        if options.get("record") is False:
            del options["record"]  # Older cohorts, which do not know of it, keep their results.
        for seed in options.pop("seeds", (None,)):
            yield name, options, seed


def _added_measures(step: str) -> tuple[str, ...]:
    """Return what plug-ins measure in a step, so that jobs that were done without them are done again."""
    added = [item.name for item in measured_in(step) if item.name not in QUANTITIES.builtin]
    return tuple(f"{QUANTITIES.distribution(name)}:{name}" for name in added)


def _policy_digest(path: Path) -> str:
    try:
        return f"sha256:{sha256(path.read_bytes()).hexdigest()}"
    except OSError as error:
        raise MimocError(f"{path}: the policy cannot be read ({error.strerror}); check the path") from None


def _text(data: Any) -> str:
    return json.dumps(data, sort_keys=True, separators=(",", ":"), ensure_ascii=False, default=dict)


def import_function(name: str, folder: str) -> Callable[..., Any]:
    """Return a function named as `module:function`, perhaps in a folder; raise a MimocError if there is none."""
    module_name, _, function = name.partition(":")
    with _found_in(folder):
        known = sys.modules.get(module_name)
        wanted = _beside(module_name, folder)
        if known and wanted and getattr(known, "__file__", None) != wanted.origin:
            del sys.modules[module_name]  # It is from elsewhere, such as from beside another cohort file.
        try:
            module = import_module(module_name)
        except ImportError as error:
            raise MimocError(f"'{name}': {error}; put the module beside the cohort file, or install it") from None
    if not callable(user_function := getattr(module, function, None)):
        raise MimocError(f"'{name}': the module has no function '{function}'")
    return user_function


def digest_of(name: str, folder: str) -> str:
    """Return the digest of a function's module, so that jobs with an older version are done again; or a MimocError."""
    module_name = name.partition(":")[0]
    with _found_in(folder):
        try:
            spec = _beside(module_name, folder) or find_spec(module_name)
        except (ImportError, ValueError):
            spec = None
        except Exception as error:  # Whatever the package that the module is in does when it is imported.
            raise MimocError(f"'{name}': its package cannot be imported ({error}); mend it") from None
    if spec is None:
        raise MimocError(f"'{name}': there is no module '{module_name}'; put it beside the cohort file, or install it")
    source = Path(spec.origin or "")
    return f"sha256:{sha256(source.read_bytes()).hexdigest()}" if source.is_file() else ""


def _beside(module: str, folder: str) -> ModuleSpec | None:
    """Return where a module is in a folder; None if it is not there, or is part of a package."""
    return None if "." in module else PathFinder.find_spec(module, [folder])


@contextmanager
def _found_in(folder: str) -> Iterator[None]:
    invalidate_caches()
    sys.path.insert(0, folder)
    try:
        yield
    finally:
        sys.path.remove(folder)

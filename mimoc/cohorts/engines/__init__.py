"""Engines: where the jobs of a cohort are done.

An engine is one module here, listed in `ENGINES`. Its `OPTIONS` are the names of its options, and `check(options)`
raises if it cannot run with them. `run(jobs, store, options, done)` has every job done by
`mimoc.cohorts.perform.run_jobs(jobs, store)`, in some process that sees the cohort's folder, which writes a result for
each; and it calls `done` with the number of jobs that have one, whenever there are more. It returns when all have one,
or raises. When an exception such as KeyboardInterrupt leaves it, it ends what it has started. Jobs and store can be
pickled; jobs may be handed out twice. A job that has no result after `run` has returned counts as failed.
"""

from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from typing import Any, Protocol

from mimoc.cohorts.job import Job
from mimoc.cohorts.store import Store
from mimoc.errors import UnknownNameError

Done = Callable[[int], None]
"""Called with the number of jobs that have a result now."""

ENGINES: Mapping[str, str] = {
    "local": "mimoc.cohorts.engines.local",
    "slurm": "mimoc.cohorts.engines.slurm",
    "ray": "mimoc.cohorts.engines.ray",
}
"""Module of each engine, imported when needed."""


class Engine(Protocol):
    """What does jobs."""

    def __call__(self, jobs: Sequence[Job], store: Store, options: Mapping[str, Any], done: Done) -> None:
        """Do jobs; see above."""
        ...


def find_engine(name: str, options: Mapping[str, Any]) -> Engine:
    """Return an engine that can run with some options.

    Raises:
        UnknownNameError: If there is none of this name, or it has no such option.
        MissingExtraError: If what it needs is not installed.
        MimocError: If it cannot run here, or an option has an impossible value.
    """
    if name not in ENGINES:
        raise UnknownNameError("place to run a cohort on", name, ENGINES)
    engine = import_module(ENGINES[name])
    for option in options:
        if option not in engine.OPTIONS:
            raise UnknownNameError(f"setting of '--on {name}'", option, engine.OPTIONS)
    engine.check(options)
    return engine.run

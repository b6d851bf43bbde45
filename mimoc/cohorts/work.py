"""What a job is done with: its infant, its seed, and a folder of its own."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from mimoc.bundle.io import Bundle
from mimoc.cohorts.job import Job
from mimoc.cohorts.store import Store
from mimoc.compiler.building import builder, sees_skin
from mimoc.schema.infant import InfantSpec, read_spec
from mimoc.schema.source import in_memory_as_text


@dataclass(frozen=True)
class Work:
    """A job that is being done; functions of the user's own are called with it."""

    job: Job
    store: Store
    workspace: "JobWorkspace"
    """The infant that this process built last."""
    measures: dict[str, Any] = field(default_factory=dict)
    """What has been measured so far, by name."""

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
        return self.workspace.spec(self.job)

    @property
    def bundle(self) -> Bundle:
        """The infant; it is built when first asked for."""
        return self.workspace.bundle(self.job)

    @cached_property
    def folder(self) -> Path:
        """An empty folder for files of this job, which are kept."""
        return self.store.runs(self.job, empty=True)


class JobWorkspace:
    """Keeps the infant that was built last, since the jobs of one infant come one after the other."""

    def __init__(self) -> None:
        """Begin with nothing."""
        self._infant = ""
        self._spec: InfantSpec | None = None
        self._bundle: Bundle | None = None

    def spec(self, job: Job) -> InfantSpec:
        """Return the spec of a job's infant.

        Raises:
            SpecError: If there is no such infant.
        """
        if self._spec is None or self._infant != job.infant:
            self._infant, self._spec, self._bundle = "", None, None
            self._spec = read_spec(in_memory_as_text(dict(job.data or {}), f"<{job.cohort}>", Path(job.spec_folder)))
            self._infant = job.infant
        return self._spec

    def bundle(self, job: Job) -> Bundle:
        """Return a job's infant.

        Raises:
            SpecError: If there is no such infant.
            ModelError: If MuJoCo rejects its model.
        """
        spec = self.spec(job)
        if self._bundle is None:
            self._bundle = builder(spec, skin=sees_skin(spec))(spec.scene.seed)
        return self._bundle

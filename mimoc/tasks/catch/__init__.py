"""Catch a ball that falls on the open hand."""

from mimoc.kinds import TaskKind
from mimoc.tasks.catch.spec import CatchEntry, CatchSpec

KIND = TaskKind(
    name="catch",
    spec=CatchSpec,
    entry=CatchEntry,
    build="mimoc.tasks.catch.build",
    run="mimoc.tasks.catch.run",
    scenes=("flat", "crib", "room"),
)

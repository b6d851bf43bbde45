"""Touch a ball that hangs within reach."""

from mimoc.kinds import TaskKind
from mimoc.tasks.reach.spec import ReachEntry, ReachSpec

KIND = TaskKind(
    name="reach",
    spec=ReachSpec,
    entry=ReachEntry,
    build="mimoc.tasks.reach.build",
    run="mimoc.tasks.reach.run",
)

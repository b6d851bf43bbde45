"""Stand up, holding on to a rail."""

from mimoc.kinds import TaskKind
from mimoc.tasks.standup.spec import StandupEntry, StandupSpec

KIND = TaskKind(
    name="standup",
    spec=StandupSpec,
    entry=StandupEntry,
    build="mimoc.tasks.standup.build",
    run="mimoc.tasks.standup.run",
    scenes=("flat",),
)

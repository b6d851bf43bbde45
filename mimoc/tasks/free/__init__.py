"""No goal: the reward is zero, and episodes do not end."""

from mimoc.kinds import TaskKind
from mimoc.tasks.free.spec import FreeEntry, FreeSpec

KIND = TaskKind(
    name="free",
    spec=FreeSpec,
    entry=FreeEntry,
    build="mimoc.tasks.free.build",
    run="mimoc.tasks.free.run",
    poses=None,
)

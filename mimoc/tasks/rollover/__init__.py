"""Turn over, from the back to the belly or the other way."""

from mimoc.kinds import TaskKind
from mimoc.tasks.rollover.spec import RolloverEntry, RolloverSpec

KIND = TaskKind(
    name="rollover",
    spec=RolloverSpec,
    entry=RolloverEntry,
    build="mimoc.tasks.rollover.build",
    run="mimoc.tasks.rollover.run",
    scenes=("flat", "crib", "room"),
    poses=("supine", "prone"),
)

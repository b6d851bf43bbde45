"""Touch the part of the own body that the observation names."""

from mimoc.kinds import TaskKind
from mimoc.tasks.selfbody.spec import SelfbodyEntry, SelfbodySpec

KIND = TaskKind(
    name="selfbody",
    spec=SelfbodySpec,
    entry=SelfbodyEntry,
    build="mimoc.tasks.selfbody.build",
    run="mimoc.tasks.selfbody.run",
    step_ms=5.0,
)

"""Tasks, each in its own folder."""

from mimoc.base.kinds import Kinds, TaskKind

TASKS: Kinds[TaskKind] = Kinds(
    "task",
    {
        "reach": "mimoc.tasks.reach",
        "standup": "mimoc.tasks.standup",
        "selfbody": "mimoc.tasks.selfbody",
        "catch": "mimoc.tasks.catch",
        "rollover": "mimoc.tasks.rollover",
        "free": "mimoc.tasks.free",
    },
)

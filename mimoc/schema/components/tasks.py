"""Tasks, each in its own folder."""

from mimoc.base.kinds import Kinds
from mimoc.schema.kinds import TaskKind

SKILLS = ("roll", "sit_up", "sit", "crawl", "pull_to_stand", "stand", "cruise", "walk", "grasp")
"""Tasks that are motor skills of infants, in the order in which they come; see `mimoc.components.tasks.skills`."""

TASKS: Kinds[TaskKind] = Kinds(
    "task",
    {
        "reach": "mimoc.components.tasks.reach",
        "standup": "mimoc.components.tasks.standup",
        "selfbody": "mimoc.components.tasks.selfbody",
        "catch": "mimoc.components.tasks.catch",
        "rollover": "mimoc.components.tasks.rollover",
        **{name: f"mimoc.components.tasks.skills:{name.upper()}" for name in SKILLS},
        "free": "mimoc.components.tasks.free",
    },
)

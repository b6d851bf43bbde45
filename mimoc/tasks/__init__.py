"""Tasks, each in its own folder."""

from mimoc.base.kinds import Kinds, TaskKind

SKILLS = ("roll", "sit_up", "sit", "crawl", "pull_to_stand", "stand", "cruise", "walk", "grasp")
"""Tasks that are motor skills of infants, in the order in which they come; see `mimoc.tasks.skills`."""

TASKS: Kinds[TaskKind] = Kinds(
    "task",
    {
        "reach": "mimoc.tasks.reach",
        "standup": "mimoc.tasks.standup",
        "selfbody": "mimoc.tasks.selfbody",
        "catch": "mimoc.tasks.catch",
        "rollover": "mimoc.tasks.rollover",
        **{name: f"mimoc.tasks.skills:{name.upper()}" for name in SKILLS},
        "free": "mimoc.tasks.free",
    },
)

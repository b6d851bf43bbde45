"""Policies that need no training."""

from mimoc.base.kinds import Kinds, PolicyKind

POLICIES: Kinds[PolicyKind] = Kinds(
    "policy",
    {
        "random": PolicyKind(
            "random",
            "draws every command uniformly from its range",
            "mimoc.policies.random",
            many="mimoc.policies.random",
        ),
        "zero": PolicyKind("zero", "commands zero", "mimoc.policies.zero", many="mimoc.policies.zero"),
        "reach": PolicyKind("reach", "reaches by inverse dynamics; not for servos", "mimoc.policies.reach"),
        "general_movements": PolicyKind(
            "general_movements",
            "moves by itself as infants of its age do",
            "mimoc.policies.general_movements.binding",
            many="mimoc.policies.general_movements.binding",
        ),
        "reflexes": PolicyKind(
            "reflexes",
            "has the reflexes of its age, or, by months, of a child that is later",
            "mimoc.policies.reflexes.binding",
            argument="[MONTHS]",
            many="mimoc.policies.reflexes.binding",
        ),
        "skill": PolicyKind(
            "skill",
            "does what was found for a skill, such as roll, or what is in a file of `mimoc skill`",
            "mimoc.policies.skill",
            argument="NAME",
        ),
        "motion": PolicyKind("motion", "follows a recorded motion; not for servos", "mimoc.policies.motion", "DIR"),
    },
)

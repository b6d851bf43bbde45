"""Policies that need no training."""

from functools import partial

from mimoc.base.kinds import Kinds, PolicyKind

_behaviour = partial(PolicyKind, is_behaviour=True)
_IN = "mimoc.policies.behaviours"
_BEHAVIOURS = (
    _behaviour("hold", "keeps the pose of the start", f"{_IN}.hold"),
    _behaviour("sit", "sits without support", f"{_IN}.sit", "[OPTIONS]"),
    _behaviour("prone", "lies on its forearms, head up", f"{_IN}.prone"),
    _behaviour("hands_and_knees", "keeps on hands and knees", f"{_IN}.hands_and_knees", "[OPTIONS]"),
    _behaviour("stand", "stands alone", f"{_IN}.stand", "[OPTIONS]"),
    _behaviour("kick", "kicks on its back", f"{_IN}.kick", "[LEG]"),
    _behaviour("look_at", "looks at a toy, a part of a body, another infant or a place", f"{_IN}.look", "TARGET"),
    _behaviour("reach_for", "reaches for one with a hand", f"{_IN}.reach", "TARGET[,HAND]"),
)
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
        **{kind.name: kind for kind in _BEHAVIOURS},
    },
)

"""Policies that need no training."""

from mimoc.base.kinds import Kinds, PolicyKind

POLICIES: Kinds[PolicyKind] = Kinds(
    "policy",
    {
        "random": PolicyKind("random", "draws every command uniformly from its range", "mimoc.policies.random"),
        "zero": PolicyKind("zero", "commands zero", "mimoc.policies.zero"),
        "reach": PolicyKind("reach", "reaches by inverse dynamics; not for servos", "mimoc.policies.reach"),
        "motion": PolicyKind("motion", "follows a recorded motion; not for servos", "mimoc.policies.motion", "DIR"),
    },
)

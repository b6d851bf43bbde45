"""Policies that need no training."""

from mimoc.kinds import Kinds, PolicyKind, by_name

POLICIES: Kinds[PolicyKind] = Kinds(
    "policy",
    by_name(
        (
            PolicyKind("random", "draws every command uniformly from its range", "mimoc.policies.random"),
            PolicyKind("zero", "commands nothing", "mimoc.policies.zero"),
            PolicyKind(
                "reach", "reaches for random targets by inverse dynamics; not for servos", "mimoc.policies.reach"
            ),
        )
    ),
)

"""What an infant perceives: the senses, a folder each."""

from mimoc.base.kinds import Kinds, SenseKind

SENSES: Kinds[SenseKind] = Kinds(
    "sense",
    {
        "proprioception": "mimoc.senses.proprioception",
        "vestibular": "mimoc.senses.vestibular",
        "touch": "mimoc.senses.touch",
        "vision": "mimoc.senses.vision",
        "hearing": "mimoc.senses.hearing",
        "pain": "mimoc.senses.pain",
    },
)
"""In the order of the observation."""

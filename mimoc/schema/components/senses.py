"""What an infant perceives: the senses, a folder each."""

from mimoc.base.kinds import Kinds
from mimoc.schema.kinds import SenseKind

SENSES: Kinds[SenseKind] = Kinds(
    "sense",
    {
        "proprioception": "mimoc.components.senses.proprioception",
        "vestibular": "mimoc.components.senses.vestibular",
        "touch": "mimoc.components.senses.touch",
        "vision": "mimoc.components.senses.vision",
        "hearing": "mimoc.components.senses.hearing",
        "pain": "mimoc.components.senses.pain",
    },
)
"""In the order of the observation."""

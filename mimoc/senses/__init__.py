"""What an infant perceives: the senses, a folder each."""

from mimoc.kinds import Kinds, SenseKind, by_name
from mimoc.senses.proprioception import PROPRIOCEPTION
from mimoc.senses.touch import TOUCH
from mimoc.senses.vestibular import VESTIBULAR
from mimoc.senses.vision import VISION

SENSES: Kinds[SenseKind] = Kinds("sense", by_name((PROPRIOCEPTION, VESTIBULAR, TOUCH, VISION)))
"""In the order of the observation."""

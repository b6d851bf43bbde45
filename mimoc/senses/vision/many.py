"""The vision of many infants at once: each thread draws with an OpenGL context of its own."""

from collections.abc import Sequence

from mimoc.senses.joined import OneByOne, Simulations
from mimoc.senses.sense import Sample, Sense
from mimoc.senses.vision.run import Vision


class JoinedVision(OneByOne):
    """Eyes of many infants, which share what they draw with."""

    def __init__(self, senses: Sequence[Vision]):
        """Join the vision of each infant."""
        super().__init__(senses)
        self._visions = senses

    def read(self, simulations: Simulations, infants: Sequence[int]) -> Sequence[Sample]:
        """Return the pictures of each."""

        def see(infant: int) -> Sample:
            return self._visions[infant](simulations.datas[infant])

        return simulations.each(see, infants)


def join(senses: Sequence[Sense]) -> JoinedVision | None:
    """Return the vision of many infants, or None if some draw with OpenGL contexts of their own."""
    visions = [sense for sense in senses if isinstance(sense, Vision) and sense.eyes.shares]
    return JoinedVision(visions) if len(visions) == len(senses) else None

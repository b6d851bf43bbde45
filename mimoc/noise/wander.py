"""Jitter of a delay: a whole number of physics steps that wanders between two bounds."""

from mimoc.noise.streams import NoiseStreams
from mimoc.random_streams import whole_between


class Wander:
    """The deviation of a delay, which grows by a physics step, shrinks by one or stays, each with probability 1/3.

    At the bounds it stays instead of leaving them. All values from -most to most are equally likely at any time, so
    that the mean deviation is 0 and the standard deviation is the root of most (most + 1) / 3. As a delay never grows
    faster than time passes, no signal overtakes an earlier one.
    """

    def __init__(self, most: int, streams: NoiseStreams, channel: str):
        """Wander between -most and most physics steps, by the stream of a channel."""
        self._most, self._streams, self._channel = most, streams, channel
        self.steps = 0
        """The present deviation, in physics steps."""

    def reset(self) -> None:
        """Begin at any value."""
        self.steps = whole_between(self._streams[self._channel], -self._most, self._most)

    def advance(self, physics_steps: int) -> list[int]:
        """Return the deviation after each of some physics steps."""
        found = []
        for drawn in self._streams[self._channel].random(physics_steps).tolist():
            self.steps = max(-self._most, min(self._most, self.steps + int(3 * drawn) - 1))
            found.append(self.steps)
        return found

"""Random numbers of the noise: a stream for each channel, so that no channel changes what another draws."""

from typing import Any

import numpy as np

from mimoc.random_streams import stream

SEEDS = 2**128
"""Number of seeds there are: Gymnasium calls the seed of a generator that was set directly -1."""


class NoiseStreams:
    """The streams of an environment; each begins when its channel first draws from it."""

    def __init__(self, seed: int):
        """Begin all streams at a seed."""
        self.restart(seed)

    def restart(self, seed: int) -> None:
        """Begin all streams again, at another seed."""
        self._seed = seed % SEEDS
        self._streams: dict[str, np.random.Generator] = {}

    def __getitem__(self, channel: str) -> np.random.Generator:
        """Return the stream of a channel, such as `motor`."""
        if channel not in self._streams:
            self._streams[channel] = stream(self._seed, f"noise.{channel}")
        return self._streams[channel]

    @property
    def state(self) -> dict[str, Any]:
        """The seed, and where each stream is."""
        channels = {channel: generator.bit_generator.state for channel, generator in self._streams.items()}
        return {"seed": self._seed, "channels": channels}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        self.restart(state["seed"])
        for channel, at in state["channels"].items():
            self[channel].bit_generator.state = at

"""Noise of the samples of a sense, drawn where and when they are taken: before their delay."""

import math
from typing import Any, Protocol

import mujoco
import numpy as np

from mimoc.kinds import function_of
from mimoc.noise.spec import NoiseEntry, noise_keys
from mimoc.noise.streams import NoiseStreams
from mimoc.senses import SENSES
from mimoc.senses.sense import Sample, Sense
from mimoc.units import ms_to_s


class SenseNoise(Protocol):
    """Disturbs the samples of a sense."""

    state: Any
    """What its next sample depends on besides the random numbers, to be copied; None if nothing."""

    def __call__(self, sample: Sample, elapsed_s: float, generator: np.random.Generator) -> Sample:
        """Return a sample with noise; it may be changed in place.

        Args:
            sample: What the sense returned.
            elapsed_s: Time since the last sample; infinite for the first one.
            generator: Random numbers of this sense alone.
        """
        ...


class NoisySense:
    """A sense as `Sense.__call__`, with noise."""

    def __init__(self, name: str, sense: Sense, noise: SenseNoise, streams: NoiseStreams):
        """Disturb a sense by the stream of its name."""
        self._name, self._sense, self._noise, self._streams = name, sense, noise, streams
        self._time_s = -math.inf

    def reset(self) -> None:
        """Forget the samples taken so far."""
        self._time_s = -math.inf

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return the sample at this physics step, as a new array."""
        return self.disturb(self._sense(data), data)

    def disturb(self, sample: Sample, data: mujoco.MjData) -> Sample:
        """Return the sample that the sense took at this physics step, with noise; it may be changed in place."""
        elapsed_s, self._time_s = data.time - self._time_s, data.time
        return self._noise(sample, elapsed_s, self._streams[self._name])

    @property
    def state(self) -> list[Any]:
        """When the last sample was taken, and the state of the noise."""
        return [self._time_s, self._noise.state]

    @state.setter
    def state(self, state: list[Any]) -> None:
        self._time_s, self._noise.state = state


def noisy(name: str, sense: Sense, entry: NoiseEntry, streams: NoiseStreams) -> NoisySense | None:
    """Return a sense with its noise, or None if it has none."""
    option = SENSES[name].noise if name in SENSES else None
    amount = getattr(entry, noise_keys()[name]) if option else 0.0
    if not option or not amount:
        return None
    return NoisySense(name, sense, function_of(option.run, "bind")(amount, sense, ms_to_s(entry.low_pass_ms)), streams)

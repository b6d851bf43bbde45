"""Noise as a term: from a signal of k infants, the state of its noise, and random numbers, to the disturbed signal.

    @dataclass(frozen=True)
    class Tremor(Noise):
        deviation_rad: np.ndarray       # Shape (1,)
        low_pass: LowPass

        def __call__(self, draw, sample, state):
            state = self.low_pass(state, draw.elapsed_s, draw.normals(sample.shape))
            return sample + self.deviation_rad * state, state

It is a term as those of senses are (`mimoc.runtime.term`), so one definition runs on one infant, on many, and on a
device. On the CPU, each infant draws from its own stream (`mimoc.noise.streams`).
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.kinds import function_of
from mimoc.noise.spec import NoiseEntry, noise_keys
from mimoc.noise.streams import NoiseStreams
from mimoc.runtime.array_library import NUMPY
from mimoc.runtime.term import Term, stack_terms
from mimoc.senses import SENSES
from mimoc.senses.sense import FloatArray, Sample, Sense
from mimoc.units import ms_to_s

BoolArray = npt.NDArray[np.bool_]


@dataclass(slots=True)  # Not frozen, which would take three times as long to make.
class Draw:
    """What noise is made of at one time."""

    xp: Any
    """The array library."""
    elapsed_s: float
    """Time since the state; infinite if there is none."""
    _normals: Callable[[Sequence[int], Any], Any]

    def normals(self, shape: Sequence[int], where: Any = None) -> Any:
        """Return random numbers with mean 0 and standard deviation 1.

        Args:
            shape: Their shape, (k, ...).
            where: Which of them are needed, an array of bool of this shape; others may be anything. None is all.
        """
        return self._normals(shape, where)


@dataclass(frozen=True)
class Noise(Term):
    """A base for noise."""

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:  # pyright: ignore[reportIncompatibleMethodOverride] - It reads no worlds.
        """Return the signal with noise as a new array, and the state of the noise then.

        Args:
            draw: Random numbers and the time.
            sample: The signal, shape (k, ...).
            state: An array of shape (k, ...), or None at the start of an episode, and always for noise without a state.
        """
        raise NotImplementedError


class SignalNoise:
    """The noise of one signal of one infant, with its state and its stream of random numbers."""

    def __init__(self, noise: Noise, channel: str, streams: NoiseStreams):
        """Disturb a signal by the stream of a channel."""
        self._noise: Noise = stack_terms([noise])
        self._channel, self._streams = channel, streams
        self.state: list[Any] = [-math.inf, None]
        """When the last sample was taken [s], and the state of the noise; neither is changed in place."""

    def reset(self) -> None:
        """Forget the samples taken so far."""
        self.state = [-math.inf, None]

    def at(self, time_s: float, sample: Sample) -> Sample:
        """Return the sample of some time with noise, as a new array."""
        noisy = self(time_s - self.state[0], sample)
        self.state = [time_s, self.state[1]]
        return noisy

    def __call__(self, elapsed_s: float, sample: Sample) -> Sample:
        """Return a sample with noise, as a new array, some time after the last one; infinite begins an episode."""
        former_s, state = self.state
        draw = Draw(NUMPY, elapsed_s, self._normals)
        noisy, state = self._noise(draw, sample[None], None if elapsed_s == math.inf else state)
        self.state = [former_s, state]
        return noisy[0]

    def _normals(self, shape: Sequence[int], where: BoolArray | None) -> FloatArray:
        generator = self._streams[self._channel]
        if where is None:
            return generator.standard_normal(shape)
        numbers = np.zeros(shape)
        numbers[where] = generator.standard_normal(np.count_nonzero(where))
        return numbers


def noise_amount(sense: str, entry: NoiseEntry) -> float:
    """Return how much noise a sense has, in the unit of its key; 0 if it has none, or can have none."""
    return getattr(entry, noise_keys()[sense]) if sense in noise_keys() else 0.0


def bind_noise(name: str, sense: Sense, entry: NoiseEntry) -> Noise:
    """Return the noise of a sense that can have one; its amount may be 0."""
    option: Any = SENSES[name].noise
    return function_of(option.run, "bind")(noise_amount(name, entry), sense, ms_to_s(entry.low_pass_ms))


def noise_of(name: str, sense: Sense, entry: NoiseEntry, streams: NoiseStreams) -> SignalNoise | None:
    """Return the noise of a sense of one infant, drawn by the stream of its name, or None if it has none."""
    return SignalNoise(bind_noise(name, sense, entry), name, streams) if noise_amount(name, entry) else None

"""Noise as a term: from a signal of k infants, the state of its noise, and random numbers, to the disturbed signal.

    @dataclass(frozen=True)
    class Tremor(Noise):
        deviation_rad: np.ndarray       # Shape (1,)
        low_pass: LowPass

        def __call__(self, draw, sample, state):
            state = self.low_pass(state, draw.elapsed_s, draw.normals(sample.shape))
            return sample + self.deviation_rad * state, state

It is a term as those of senses are (`mimoc.runtime.term`), so one definition runs on one infant, on many, and on a
device. On the CPU, each infant draws from its own streams (`NoiseStreams`). Commands have such noise too: each actuator
is driven by its command and noise in proportion to it.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.kinds import function_of
from mimoc.base.random_streams import stream
from mimoc.base.units import ms_to_s
from mimoc.runtime.actuation import Actuation, as_slice
from mimoc.runtime.filter import Filter
from mimoc.runtime.sense import FloatArray, Sample, Sense
from mimoc.runtime.term import Term, stack_terms
from mimoc.runtime.worlds import NUMPY
from mimoc.schema.kinds import SENSES
from mimoc.schema.senses import MOTOR, NoiseEntry, low_pass_key, noise_keys

SEEDS = 2**128  # Number of seeds there are: Gymnasium calls the seed of a generator that was set directly -1.


class NoiseStreams:
    """The streams of an environment, one for each channel, so that no channel changes what another draws.

    Each begins when its channel first draws from it, and is one and the same generator for good.
    """

    def __init__(self, seed: int):
        self._generators: dict[str, np.random.Generator] = {}
        self.restart(seed)

    def restart(self, seed: int) -> None:
        """Restart all streams from another seed."""
        self._seed = seed % SEEDS
        self._streams: dict[str, np.random.Generator] = {}

    def __getitem__(self, channel: str) -> np.random.Generator:
        if channel not in self._streams:
            begun = stream(self._seed, f"noise.{channel}")
            self._streams[channel] = self._generators.setdefault(channel, begun)
            self._streams[channel].bit_generator.state = begun.bit_generator.state
        return self._streams[channel]

    @property
    def state(self) -> dict[str, Any]:
        """The seed, and the state of each stream."""
        channels = {channel: generator.bit_generator.state for channel, generator in self._streams.items()}
        return {"seed": self._seed, "channels": channels}

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        self.restart(state["seed"])
        for channel, at in state["channels"].items():
            self[channel].bit_generator.state = at


@dataclass(slots=True)  # Not frozen, which would take three times as long to make.
class Draw:
    """The random numbers and the time of one sample."""

    xp: Any  # The array library.
    elapsed_s: float  # Time since the state; infinite if there is none.
    normals: Callable[..., Any]
    """Returns, for a shape (k, ...), random numbers with mean 0 and standard deviation 1; an array of bool of this
    shape as second argument marks those that are needed: others may be anything then."""


@dataclass(frozen=True)
class Noise(Term):
    """A base for noise."""

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
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
        self._noise: Noise = stack_terms([noise])
        self._channel, self._streams = channel, streams
        self.reset()

    def reset(self) -> None:
        """Forget the samples taken so far."""
        self.state: list[Any] = [-math.inf, None]  # Time of the last sample [s], and state of the noise.

    def at(self, time_s: float, sample: Sample) -> Sample:
        """Return the sample of a time with noise, as a new array."""
        former_s, state = self.state
        noisy, state = self._noise(Draw(NUMPY, time_s - former_s, self._normals), sample[None], state)
        self.state = [time_s, state]
        return noisy[0]

    def _normals(self, shape: Sequence[int], where: npt.NDArray[np.bool_] | None = None) -> FloatArray:
        generator = self._streams[self._channel]
        if where is None:
            return generator.standard_normal(shape)
        numbers = np.zeros(shape)
        numbers[where] = generator.standard_normal(np.count_nonzero(where))
        return numbers


def noise_amount(sense: str, entry: NoiseEntry) -> float:
    """Return how much noise a sense has, in the unit of its key; 0 if it has none."""
    return getattr(entry, noise_keys()[sense]) if sense in noise_keys() else 0.0


def bind_noise(name: str, sense: Sense, entry: NoiseEntry) -> Noise:
    """Return the noise of a sense that can have one; its amount may be 0."""
    option: Any = SENSES[name].noise
    low_pass_ms = getattr(entry, low_pass_key(name), None) or entry.low_pass_ms
    return function_of(option.run, "bind")(noise_amount(name, entry), sense, ms_to_s(low_pass_ms))


@dataclass(frozen=True)
class Filtered(Noise):
    """What a sense organ makes of a signal, and the noise of that, if it has any."""

    filter: Filter
    noise: Noise | None

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return the response with noise, and the states of filter and noise, one after the other."""
        if self.noise is None:
            return self.filter(draw.xp, draw.elapsed_s, sample, state)
        size = self.filter.size(sample.shape[1])
        former, noisy = (None, None) if state is None else (state[:, :size], state[:, size:])
        response, kept = self.filter(draw.xp, draw.elapsed_s, sample, former)
        response, noise = self.noise(draw, response, noisy)
        return response, kept if noise is None else draw.xp.concat([kept, noise], axis=1)


def processing_of(name: str, sense: Sense, entry: NoiseEntry, force: bool = False) -> Noise | None:
    """Return the filter and noise of a sense, or None if it has neither; *force* keeps noise of amount 0."""
    noise = bind_noise(name, sense, entry) if noise_amount(name, entry) or (force and name in noise_keys()) else None
    return noise if sense.filter is None else Filtered(sense.filter, noise)


def noise_of(name: str, sense: Sense, entry: NoiseEntry, streams: NoiseStreams) -> SignalNoise | None:
    """Return the noise of a sense of one infant, drawn from the stream of its name, or None."""
    noise = processing_of(name, sense, entry)
    return SignalNoise(noise, name, streams) if noise else None


FORGOTTEN = 700.0  # Number of time constants after which nothing of a value is left.


@dataclass(frozen=True, slots=True)
class LowPass:
    """White noise after a low-pass filter of first order, whose values correlate by exp(-t / T) over a time t.

    With random numbers n, a value x becomes a x + √(1 - a²) n after a time t, where a = exp(-t / T). Its mean is 0
    and its standard deviation 1 for any interval between values, so neither depends on the physics step.
    """

    time_constant_s: float  # T.

    def __call__(self, values: Any, elapsed_s: float, drawn: Any) -> Any:
        """Return the values after some time, shape (k, n); those drawn if there are none before."""
        if values is None:
            return drawn
        kept = math.exp(-elapsed_s / self.time_constant_s)
        return kept * values + math.sqrt(1 - kept * kept) * drawn


@dataclass(frozen=True, slots=True)
class Smooth:
    """White noise after a critically damped low-pass filter of second order: smooth values, and their rates.

    A value has the standard deviation 1, its rate 1 / T, and the rate is the derivative of the value. With p = t / T, a
    value and T times its rate, z = (x, y), become A z + L n after a time t, where A = exp(-p) (1 + p, p; -p, 1 - p),
    and L is lower triangular with L Lᵀ = 1 - A Aᵀ.
    """

    time_constant_s: float  # T.

    def __call__(self, xp: Any, values: Any, elapsed_s: float, drawn: Any) -> Any:
        """Return the values, then T times their rates after some time, shape (k, 2 n); see `LowPass`."""
        if values is None:
            return drawn
        (xx, xy), (yx, yy), (first, mixed, second) = smooth_step(elapsed_s / self.time_constant_s)
        count = values.shape[1] // 2
        value = values[:, :count]
        rate = values[:, count:]
        one = drawn[:, :count]
        other = drawn[:, count:]
        changed = [xx * value + xy * rate + first * one, yx * value + yy * rate + (mixed * one + second * other)]
        return xp.concat(changed, axis=1)


def smooth_step(times: float) -> tuple[tuple[float, float], tuple[float, float], tuple[float, float, float]]:
    """Return both rows of A, and the numbers of L row by row, after some time constants; see `Smooth`."""
    past = min(times, FORGOTTEN)
    decay = math.exp(-past)
    value = (decay * (1 + past), decay * past)
    rate = (decay * -past, decay * (1 - past))
    first = math.sqrt(max(1 - value[0] ** 2 - value[1] ** 2, 0.0))
    mixed = -(value[0] * rate[0] + value[1] * rate[1]) / first if first else 0.0
    return value, rate, (first, mixed, math.sqrt(max(1 - rate[0] ** 2 - rate[1] ** 2 - mixed * mixed, 0.0)))


@dataclass(frozen=True)
class MotorNoise(Noise):
    """Signal-dependent noise: commands u drive actuators by u (1 + c n), with n low-passed and of standard deviation 1.

    The standard deviation of a force thus rises in proportion to its size (Jones, Hamilton & Wolpert 2002).
    """

    share: FloatArray  # The standard deviation c, as a share of the command, shape (n,).
    low: FloatArray  # Smallest command, shape (n,).
    high: FloatArray  # Largest command, shape (n,).
    low_pass: LowPass

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return the controls, shape (k, n), and the state of the noise."""
        state = self.low_pass(state, draw.elapsed_s, draw.normals(sample.shape))
        return self.in_range(draw.xp, sample) * (1 + self.share * state), state

    def in_range(self, xp: Any, commands: Any) -> Any:
        """Return commands within their range, shape (k, n)."""
        return xp.minimum(xp.maximum(commands, self.low), self.high)


@dataclass(frozen=True)
class BandLimited(Noise):
    """Commands that pass two low-pass filters of first order, one after the other, and then have their noise.

    So a command at a frequency f arrives with the share 1 / (1 + (f / cut-off)²) of its amplitude.
    """

    noise: MotorNoise
    cut_off_rad_s: FloatArray  # Cut-off of each filter, shape (1,).

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return the controls, shape (k, n), and the state: of the noise, and of each filter, shape (k, 3 n)."""
        xp, count = draw.xp, sample.shape[1]
        first = second = self.noise.in_range(xp, sample)
        if state is not None:
            kept = xp.exp(-draw.elapsed_s * self.cut_off_rad_s)
            first, second = passed(kept, first, state[:, count : 2 * count], state[:, 2 * count :])
        controls, noise = self.noise(draw, second, None if state is None else state[:, :count])
        return controls, xp.concat([noise, first, second], axis=1)


def passed(kept: Any, commands: Any, first: Any, second: Any) -> tuple[Any, Any]:
    """Return the outputs of both filters, given their former outputs and the share *kept* of these."""
    first = kept * first + (1 - kept) * commands
    return first, kept * second + (1 - kept) * first


def is_disturbed(entry: NoiseEntry, actuation: Actuation) -> bool:
    """Return whether commands have noise or a limited bandwidth, so that they change at each physics step."""
    return bool(entry.motor or any(entry.of_commands)) or actuation.bandwidth_hz is not None


def bind_motor_noise(entry: NoiseEntry, actuation: Actuation) -> MotorNoise | BandLimited:
    """Return the noise of all commanded actuators; its amount may be 0."""
    shares = np.array(entry.of_commands) if entry.of_commands else np.full(len(actuation.low), entry.motor)
    noise = MotorNoise(shares, actuation.low, actuation.high, LowPass(ms_to_s(entry.low_pass_ms)))
    if actuation.bandwidth_hz is None:
        return noise
    return BandLimited(noise, np.array([2 * math.pi * actuation.bandwidth_hz]))


class NoisyMotors:
    """The commands of one infant, and the noise with which they drive its actuators.

    The random numbers of all physics steps of a control step are drawn at its beginning: the same as one after another.
    """

    def __init__(
        self,
        noise: MotorNoise | BandLimited,
        physics_steps: int,
        timestep_s: float,
        actuation: Actuation,
        streams: NoiseStreams,
    ):
        self._noise: Noise = stack_terms([noise])
        self._streams = streams
        self._steps = physics_steps
        self._count = len(actuation.actuators)
        self._actuators, self._draw = as_slice(actuation.actuators), Draw(NUMPY, timestep_s, self._next)

    def reset(self, data: mujoco.MjData) -> None:
        """Restart, with the present controls as commands."""
        self.commanded = data.ctrl.copy()  # Control of each actuator of the model without noise, shape (nu,).
        self._level: Any = None
        self._prepare(1)
        self._disturbed()

    def begin(self) -> None:
        """Draw the random numbers of the next control step."""
        self._prepare(self._steps)

    def __call__(self, data: mujoco.MjData) -> None:
        """Set the controls for the next physics step."""
        data.ctrl[self._actuators] = self._disturbed()

    def _disturbed(self) -> FloatArray:
        controls, self._level = self._noise(self._draw, self.commanded[self._actuators][None], self._level)
        return controls

    def _prepare(self, count: int) -> None:
        self._numbers = iter(self._streams[MOTOR].standard_normal((count, 1, self._count)))

    def _next(self, shape: Sequence[int]) -> FloatArray:
        return next(self._numbers)

    @property
    def state(self) -> list[Any]:
        """The commands, and the state of the noise."""
        return [self.commanded, self._level]

    @state.setter
    def state(self, state: list[Any]) -> None:
        self.commanded, self._level = state

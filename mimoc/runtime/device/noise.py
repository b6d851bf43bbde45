"""Noise on a device: the terms of the CPU (`mimoc.runtime.noise`), with other random numbers.

Each random number is a function of the seed of its world, of how often that has gone on to other numbers since, and of
a place. So they depend neither on the other worlds nor on the order in which kernels run.
"""

import math
from collections.abc import Mapping, Sequence

import array_api_compat.torch as array_library
import torch
import warp as wp

from mimoc.runtime.batch.gymnasium_forms import mixture_error
from mimoc.runtime.device.arrays import term_of_worlds, where_worlds
from mimoc.runtime.device.lines import Uniforms
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.noise import Draw, Noise, bind_motor_noise, is_disturbed, processing_of
from mimoc.schema.senses import MOTOR, noise_keys

PLACES = 1 << 23  # How many random numbers a channel has at a time.
CHANNELS = 128  # How many channels of noise there are at most; the places of others are behind theirs.
SEEDS = 2**31  # How many different seeds worlds can have.


class CounterRandom:
    """The random numbers of all worlds."""

    def __init__(self, seeds: torch.Tensor):
        self.seeds = seeds.int()
        self.steps = torch.zeros_like(self.seeds)
        """How often each world has gone on to other numbers since it was seeded."""

    def restart(self, seeds: Mapping[int, int]) -> None:
        """Begin again in worlds that get a new seed."""
        worlds = list(seeds)
        self.steps[worlds] = 0
        self.seeds[worlds] = self.seeds.new_tensor([seed % SEEDS for seed in seeds.values()])

    def normals(self, first: int, shape: Sequence[int]) -> torch.Tensor:
        """Return random numbers with mean 0 and standard deviation 1 of shape (worlds, ...), from a first place on."""
        return self._drawn(_draw, first, shape)

    def uniforms_of(self, number: int) -> Uniforms:
        """Return what draws numbers from 0 to less than 1, of shape (worlds, ...), for a signal with some number."""
        return lambda shape: self._drawn(_draw_uniforms, (CHANNELS + number) * PLACES, shape)

    def _drawn(self, kernel: wp.Kernel, first: int, shape: Sequence[int]) -> torch.Tensor:
        numbers = torch.empty((shape[0], math.prod(shape[1:])), device=self.seeds.device)
        inputs = [wp.from_torch(self.seeds), wp.from_torch(self.steps), first]
        wp.launch(kernel, tuple(numbers.shape), inputs, [wp.from_torch(numbers)])
        return numbers.reshape(tuple(shape))


class DeviceNoise:
    """The noise of one signal of all worlds, with its state."""

    def __init__(self, signal: str, noises: Sequence[Noise], body: torch.Tensor, chance: CounterRandom):
        """Disturb a signal by the noise of the body in each world; each signal draws random numbers of its own."""
        self._noise, self._chance = term_of_worlds(f"noise of {signal}", noises, body), chance
        draws = [*noise_keys(), MOTOR]
        self._first = draws.index(signal) * 2 * PLACES if signal in draws else 0  # Others only have filters.
        self.state: torch.Tensor | None = None
        """The state of the noise in each world, shape (worlds, ...), if it has any."""

    def __call__(self, signal: torch.Tensor, elapsed_s: float) -> torch.Tensor:
        """Return a signal of all worlds with noise, shape (worlds, n), some time after the last one."""
        noisy, self.state = self._noise(self._draw(self._first, elapsed_s), signal, self.state)
        return noisy

    def begin(self, signal: torch.Tensor, begins: torch.Tensor) -> torch.Tensor:
        """Return the signal with noise for worlds that begin an episode, shape (worlds,); others keep their noise."""
        noisy, state = self._noise(self._draw(self._first + PLACES, math.inf), signal, None)
        is_kept = state is not None and self.state is not None
        self.state = where_worlds(begins, state, self.state) if is_kept else state
        return noisy

    def _draw(self, first: int, elapsed_s: float) -> Draw:
        return Draw(array_library, elapsed_s, lambda shape, where=None: self._chance.normals(first, shape))


def noise_of(
    signal: str, infants: Sequence[InfantEnv], body: torch.Tensor, chance: CounterRandom
) -> DeviceNoise | None:
    """Return the noise of a sense, or of the commands, of some different bodies, or None if none has any."""

    def noise(infant: InfantEnv, force: bool) -> Noise | None:
        entry, actuation = infant.manifest.noise, infant.actuation
        if signal == MOTOR:
            return bind_motor_noise(entry, actuation) if force or is_disturbed(entry, actuation) else None
        return processing_of(signal, infant.senses[signal], entry, force)

    if not any(noise(infant, force=False) for infant in infants):
        return None
    noises = [bound for infant in infants if (bound := noise(infant, force=True))]
    if len(noises) < len(infants):
        raise mixture_error("some", f"whether sense '{signal}' has a filter")
    return DeviceNoise(signal, noises, body, chance)


@wp.func
def _generator(world_seed: int, step: int, place: int) -> wp.uint32:
    """Return a generator of a place; places in which those of two worlds coincide now differ next time."""
    return wp.rand_init(wp.int32(wp.rand_init(world_seed, step)), wp.int32(wp.rand_init(place, step)))


@wp.kernel(enable_backward=False)
def _draw(seeds: wp.array[int], steps: wp.array[int], first: int, numbers: wp.array2d[float]):
    world, number = wp.tid()
    numbers[world, number] = wp.randn(_generator(seeds[world], steps[world], first + number))


@wp.kernel(enable_backward=False)
def _draw_uniforms(seeds: wp.array[int], steps: wp.array[int], first: int, numbers: wp.array2d[float]):
    world, number = wp.tid()
    numbers[world, number] = wp.randf(_generator(seeds[world], steps[world], first + number))

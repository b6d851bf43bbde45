"""Noise on a device: the terms of the CPU (`mimoc.noise.noise`), with other random numbers.

Each random number is a function of the seed of its world, of how often that has gone on to other numbers since, and of
a place. So they depend neither on the other worlds nor on the order in which kernels run.
"""

import math
from collections.abc import Mapping, Sequence

import array_api_compat.torch as array_library
import torch
import warp as wp

from mimoc.delays.spec import MOTOR
from mimoc.noise.noise import Draw, Noise, bind_motor_noise, bind_noise, noise_amount
from mimoc.noise.spec import noise_keys
from mimoc.runtime.device.arrays import put_on, term_of_worlds, where_worlds
from mimoc.runtime.env import InfantEnv

PLACES = 1 << 23
"""How many random numbers a channel has at a time."""
SEEDS = 2**31
"""How many different seeds worlds can have."""


class CounterRandom:
    """The random numbers of all worlds."""

    def __init__(self, seeds: wp.array):
        """Begin with some seeds, shape (worlds,), which may change later."""
        self.seeds = seeds
        self.is_used = False
        """Whether any noise draws from them."""
        self.steps = wp.zeros(seeds.shape[0], dtype=int)
        """How often each world has gone on to other numbers since it was seeded."""

    def advance(self) -> None:
        """Go on to other numbers."""
        wp.to_torch(self.steps).add_(1)

    def restart(self, seeds: Mapping[int, int]) -> None:
        """Begin again in worlds that get a new seed."""
        known, steps, worlds = wp.to_torch(self.seeds), wp.to_torch(self.steps), list(seeds)
        known[worlds], steps[worlds] = known.new_tensor([seed % SEEDS for seed in seeds.values()]), 0

    def normals(self, first: int, shape: Sequence[int]) -> torch.Tensor:
        """Return random numbers with mean 0 and standard deviation 1 of shape (worlds, ...), from a first place on."""
        numbers = torch.empty((shape[0], math.prod(shape[1:])), device=wp.device_to_torch(self.seeds.device))
        wp.launch(_draw, tuple(numbers.shape), [self.seeds, self.steps, first], [wp.from_torch(numbers)])
        return numbers.reshape(tuple(shape))


class DeviceNoise:
    """The noise of one signal of all worlds, with its state."""

    def __init__(self, signal: str, noises: Sequence[Noise], body: wp.array, chance: CounterRandom):
        """Disturb a signal.

        Args:
            signal: Its name, by which its random numbers differ from those of others.
            noises: Of the different bodies.
            body: Which of them lives in each world, shape (worlds,).
            chance: Random numbers.
        """
        self._noise, self._chance = term_of_worlds(f"noise of {signal}", noises, body), chance
        chance.is_used = True
        self._first = [*noise_keys(), MOTOR].index(signal) * 2 * PLACES
        self._state: torch.Tensor | None = None

    def __call__(self, signal: torch.Tensor, elapsed_s: float) -> torch.Tensor:
        """Return a signal of all worlds with noise, shape (worlds, n), some time after the last one."""
        noisy, state = self._noise(self._draw(self._first, elapsed_s), signal, self._state)
        self._keep(state)
        return noisy

    def begin(self, signal: torch.Tensor, begins: torch.Tensor) -> torch.Tensor:
        """Return the signal with noise of worlds that begin an episode, shape (worlds,); others keep their noise."""
        noisy, state = self._noise(self._draw(self._first + PLACES, math.inf), signal, None)
        self._keep(state if state is None or self._state is None else where_worlds(begins, state, self._state))
        return where_worlds(begins, noisy, signal)

    def _draw(self, first: int, elapsed_s: float) -> Draw:
        return Draw(array_library, elapsed_s, lambda shape, where=None: self._chance.normals(first, shape))

    def _keep(self, state: torch.Tensor | None) -> None:
        """Keep a state, at the same place in memory."""
        if state is None or self._state is None:
            self._state = state if state is None else state.clone()
        else:
            self._state.copy_(state)


class NoisyCommands:
    """The commands of all worlds, and the noise with which they drive actuators."""

    def __init__(self, infants: Sequence[InfantEnv], body: wp.array, chance: CounterRandom):
        """Disturb the commands in each physics step; see `DeviceNoise`."""
        noises = [bind_motor_noise(infant.manifest.noise, infant.actuation) for infant in infants]
        self._noise, self._timestep_s = DeviceNoise(MOTOR, noises, body, chance), infants[0].model.opt.timestep
        self._actuators = put_on(body.device)(infants[0].actuation.actuators)
        self.commanded = torch.zeros((body.shape[0], len(self._actuators)), device=self._actuators.device)
        """Commands without noise, shape (worlds, n)."""

    def begin(self, commands: torch.Tensor, begins: torch.Tensor) -> None:
        """Begin anew in some worlds, shape (worlds,), with their rows of commands, shape (worlds, n)."""
        self.commanded.copy_(where_worlds(begins, commands, self.commanded))
        self._noise.begin(self.commanded, begins)

    def __call__(self, controls: torch.Tensor) -> None:
        """Set the controls of the next physics step, shape (worlds, nu)."""
        controls.index_copy_(1, self._actuators, self._noise(self.commanded, self._timestep_s))


def noise_of(sense: str, infants: Sequence[InfantEnv], body: wp.array, chance: CounterRandom) -> DeviceNoise | None:
    """Return the noise of a sense of some different bodies, or None if none has any."""
    if not any(noise_amount(sense, infant.manifest.noise) for infant in infants):
        return None
    noises = [bind_noise(sense, infant.senses[sense], infant.manifest.noise) for infant in infants]
    return DeviceNoise(sense, noises, body, chance)


def motor_noise(infants: Sequence[InfantEnv], body: wp.array, chance: CounterRandom) -> NoisyCommands | None:
    """Return the commands with their noise, or None if no infant has any."""
    return NoisyCommands(infants, body, chance) if any(infant.manifest.noise.motor for infant in infants) else None


@wp.kernel(enable_backward=False)
def _draw(seeds: wp.array[int], steps: wp.array[int], first: int, numbers: wp.array2d[float]):
    """Draw numbers; places in which the generators of two worlds coincide now differ next time."""
    world, number = wp.tid()
    of_world = wp.rand_init(seeds[world], steps[world])
    of_place = wp.rand_init(first + number, steps[world])
    numbers[world, number] = wp.randn(wp.rand_init(wp.int32(of_world), wp.int32(of_place)))

"""Noise of senses and commands on a device: distributed as on the CPU, from other random numbers."""

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
import warp as wp

from mimoc.noise.low_pass import low_pass_step, smooth_step
from mimoc.noise.spec import NoiseEntry
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.arrays import put
from mimoc.runtime.warp.chance import PLACES, Chance, generator
from mimoc.senses.proprioception.run import ANGLE_UNIT, VELOCITY_UNIT
from mimoc.units import deg_to_rad, ms_to_s

ANEW = float("inf")
"""Time after which nothing of former noise is left."""
PROPRIOCEPTION, TOUCH, MOTOR = (channel * 2 * PLACES for channel in range(3))
"""Where the random numbers of each channel begin; half of them are for the begin of episodes."""


class DeviceNoise(Protocol):
    """Disturbs the samples of a sense of all infants."""

    def __call__(self, sample: wp.array, chosen: wp.array | None = None, elapsed_s: float = ANEW) -> None:
        """Add noise to samples, shape (worlds, n).

        Args:
            sample: What was sensed.
            chosen: Worlds with -1 are left as they are; None is all.
            elapsed_s: Time since the last sample.
        """
        ...


class ProprioceptionNoise:
    """Adds a smooth error to each angle, and its rate to each velocity; see `proprioception.noise`."""

    def __init__(self, infants: Sequence[InfantEnv], body: wp.array, chance: Chance, width: int):
        """Find angles and velocities."""
        self._body, self._chance = body, chance
        layout = infants[0].senses["proprioception"].layout
        angles, velocities = (
            np.flatnonzero([name.endswith(f"[{unit}]") for name in layout]) for unit in (ANGLE_UNIT, VELOCITY_UNIT)
        )
        self._places = put(np.stack([angles, velocities if len(velocities) else np.full(len(angles), -1)], 1), wp.vec2i)
        self._low_pass_s = [_low_pass_s(infant) for infant in infants]
        deviations_rad = [deg_to_rad(infant.manifest.noise.proprioception_deg) for infant in infants]
        scales = [(rad, rad / past_s) for rad, past_s in zip(deviations_rad, self._low_pass_s, strict=True)]
        self._scales, self._everyone = put(scales, wp.vec2), wp.zeros_like(body)
        self._errors = wp.zeros((body.shape[0], len(angles)), dtype=wp.vec2)
        self._steps: dict[float, list[wp.array]] = {}

    def __call__(self, sample: wp.array, chosen: wp.array | None = None, elapsed_s: float = ANEW) -> None:
        """Let the errors change, and add them."""
        if elapsed_s not in self._steps:
            steps = [smooth_step(elapsed_s, past_s) for past_s in self._low_pass_s]
            self._steps[elapsed_s] = [put(each, wp.mat22) for each in zip(*steps, strict=True)]
        first = PROPRIOCEPTION + PLACES * (chosen is not None)
        inputs = [self._chance.seeds, self._chance.steps, first, self._everyone if chosen is None else chosen]
        inputs += [self._body, self._places, self._scales, *self._steps[elapsed_s]]
        wp.launch(_drift, self._errors.shape, inputs, [self._errors, sample])


class TouchNoise:
    """Varies the size of each force, of those at points or of their sums; see `touch.noise`."""

    def __init__(self, infants: Sequence[InfantEnv], body: wp.array, chance: Chance, width: int):
        """Take how many numbers make a force."""
        self._body, self._chance, self._width, self._everyone = body, chance, width, wp.zeros_like(body)
        self._deviations_n = put([infant.manifest.noise.touch_n for infant in infants])

    def __call__(self, sample: wp.array, chosen: wp.array | None = None, elapsed_s: float = ANEW) -> None:
        """Vary what is felt now."""
        first = TOUCH + PLACES * (chosen is not None)
        inputs = [self._chance.seeds, self._chance.steps, first, self._everyone if chosen is None else chosen]
        inputs += [self._body, self._deviations_n, self._width]
        wp.launch(_vary, (sample.shape[0], sample.shape[1] // self._width), inputs, [sample])


class MotorNoise:
    """Drives actuators by their commands and noise in proportion to these; see `noise.motor`."""

    def __init__(self, infants: Sequence[InfantEnv], body: wp.array, chance: Chance, timestep_s: float):
        """Take shares, limits and time constants of all infants."""
        self._body, self._chance, self._everyone = body, chance, wp.zeros_like(body)
        self._actuators = put(infants[0].actuation.actuators, wp.int32)
        self._shares = put([infant.manifest.noise.motor for infant in infants])
        self._limits = put([np.stack([each.actuation.low, each.actuation.high], 1) for each in infants], wp.vec2)
        self._steps, self._anew = (
            put([low_pass_step(past_s, _low_pass_s(infant)) for infant in infants], wp.vec2)
            for past_s in (timestep_s, ANEW)
        )
        self.commanded = wp.zeros((body.shape[0], self._actuators.shape[0]), dtype=float)
        """Commands without noise, shape (worlds, n)."""
        self._noise = wp.zeros_like(self.commanded)

    def begin(self, chosen: wp.array, commands: wp.array) -> None:
        """Begin anew in some worlds, with their rows of a table as commands."""
        inputs = [self._chance.seeds, self._chance.steps, MOTOR + PLACES, chosen, self._body, self._anew, commands]
        wp.launch(_begin, self._noise.shape, inputs, [self._noise, self.commanded])

    def __call__(self, controls: wp.array) -> None:
        """Set the controls of the next physics step, shape (worlds, nu)."""
        inputs = [self._chance.seeds, self._chance.steps, MOTOR, self._body, self._steps, self._shares, self._limits]
        inputs += [self.commanded, self._actuators]
        wp.launch(_drive, self._noise.shape, inputs, [self._noise, controls])


SENSES: dict[str, tuple[str, Any]] = {
    "proprioception": ("proprioception_deg", ProprioceptionNoise),
    "touch": ("touch_n", TouchNoise),
}
"""Senses with noise, by the key of its amount."""


def is_noisy(infant: InfantEnv) -> bool:
    """Return whether an infant has any noise."""
    noise = infant.manifest.noise
    return noise != NoiseEntry(low_pass_ms=noise.low_pass_ms)


def noise_of(
    sense: str, infants: Sequence[InfantEnv], body: wp.array, chance: Chance, width: int
) -> DeviceNoise | None:
    """Return the noise of a sense of some different bodies, or None if none has any; a force has *width* numbers."""
    if sense not in SENSES or not any(getattr(infant.manifest.noise, SENSES[sense][0]) for infant in infants):
        return None
    return SENSES[sense][1](infants, body, chance, width)


def motor_noise(infants: Sequence[InfantEnv], body: wp.array, chance: Chance) -> MotorNoise | None:
    """Return the noise of the commands, or None if no infant has any."""
    if not any(infant.manifest.noise.motor for infant in infants):
        return None
    return MotorNoise(infants, body, chance, ms_to_s(infants[0].manifest.timestep_ms))


def _low_pass_s(infant: InfantEnv) -> float:
    return ms_to_s(infant.manifest.noise.low_pass_ms)


@wp.kernel(enable_backward=False)
def _drift(
    seeds: wp.array[int],
    steps: wp.array[int],
    first: int,
    chosen: wp.array[int],
    body: wp.array[int],
    places: wp.array[wp.vec2i],
    scales: wp.array[wp.vec2],
    kept: wp.array[wp.mat22],
    added: wp.array[wp.mat22],
    errors: wp.array2d[wp.vec2],
    sample: wp.array2d[float],
):
    world, number = wp.tid()
    if chosen[world] >= 0:
        mine = body[world]
        state = generator(seeds, steps, world, first + number)
        drawn = wp.vec2(wp.randn(state), wp.randn(state))
        error = kept[mine] @ errors[world, number] + added[mine] @ drawn
        errors[world, number] = error
        angle, velocity = places[number][0], places[number][1]
        sample[world, angle] = sample[world, angle] + scales[mine][0] * error[0]
        if velocity >= 0:
            sample[world, velocity] = sample[world, velocity] + scales[mine][1] * error[1]


@wp.kernel(enable_backward=False)
def _vary(
    seeds: wp.array[int],
    steps: wp.array[int],
    first: int,
    chosen: wp.array[int],
    body: wp.array[int],
    deviations_n: wp.array[float],
    width: int,
    sample: wp.array2d[float],
):
    world, force = wp.tid()
    squares = float(0.0)
    for number in range(width):
        squares += sample[world, force * width + number] * sample[world, force * width + number]
    if chosen[world] >= 0 and squares > 0.0:
        size = wp.sqrt(squares)
        state = generator(seeds, steps, world, first + force)
        factor = wp.max(size + deviations_n[body[world]] * wp.randn(state), 0.0) / size
        for number in range(width):
            sample[world, force * width + number] = sample[world, force * width + number] * factor


@wp.kernel(enable_backward=False)
def _begin(
    seeds: wp.array[int],
    steps: wp.array[int],
    first: int,
    chosen: wp.array[int],
    body: wp.array[int],
    anew: wp.array[wp.vec2],
    commands: wp.array2d[float],
    noise: wp.array2d[float],
    commanded: wp.array2d[float],
):
    world, number = wp.tid()
    if chosen[world] >= 0:
        state = generator(seeds, steps, world, first + number)
        noise[world, number] = anew[body[world]][1] * wp.randn(state)
        commanded[world, number] = commands[chosen[world], number]


@wp.kernel(enable_backward=False)
def _drive(
    seeds: wp.array[int],
    steps: wp.array[int],
    first: int,
    body: wp.array[int],
    low_pass: wp.array[wp.vec2],
    shares: wp.array[float],
    limits: wp.array2d[wp.vec2],
    commanded: wp.array2d[float],
    actuators: wp.array[int],
    noise: wp.array2d[float],
    controls: wp.array2d[float],
):
    world, number = wp.tid()
    mine = body[world]
    state = generator(seeds, steps, world, first + number)
    value = low_pass[mine][0] * noise[world, number] + low_pass[mine][1] * wp.randn(state)
    noise[world, number] = value
    command = wp.clamp(commanded[world, number], limits[mine, number][0], limits[mine, number][1])
    controls[world, actuators[number]] = command * (1.0 + shares[mine] * value)

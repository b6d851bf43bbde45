"""What infants on a device sense, are commanded and are judged by, bound to the bodies that live in the worlds now."""

from functools import partial
from itertools import pairwise
from typing import Any

import torch

from mimoc.base.units import to_steps
from mimoc.runtime.device.arrays import put, term_of_worlds
from mimoc.runtime.device.episode_ends import DeviceTask
from mimoc.runtime.device.noise import CounterRandom, DeviceNoise, noise_of
from mimoc.runtime.device.signals import DeviceSense, DeviceSetup, line_of, space_of
from mimoc.runtime.device.states import HISTORY, Path, Slot, attribute, in_place, nested
from mimoc.schema.delays import MOTOR


class Bound:
    """The senses, commands and tasks of all infants."""

    def __init__(self, setup: DeviceSetup, chance: CounterRandom):
        """Find what is sensed and commanded, with its delays and noise, which draw from *chance*."""
        infants, first = setup.infants, setup.infants[0]
        self.infants, self.body = infants, setup.body
        """The different bodies, and which of them lives in each world, shape (worlds,)."""
        self.task = DeviceTask(infants, setup.body)
        self.senses = {name: DeviceSense(name, setup, chance) for name in first.senses}
        self.spaces = [space_of(infant, self.senses, body) for body, infant in enumerate(infants)]
        """What each of the bodies observes."""
        self.actuators = put(first.actuation.actuators)
        self.commands = line_of(MOTOR, setup, len(self.actuators), chance, [None] * len(infants))
        commands: list[Any] = [infant.actuation.command for infant in infants]
        self.controls_of: Any = commands[0] and term_of_worlds("commands", commands, setup.body)
        self.motor_noise = noise_of(MOTOR, infants, setup.body, chance)
        period = to_steps(first.manifest.step_ms, first.manifest.timestep_ms)
        sampled = {int(period - rest) for sense in self.senses.values() for rest in sense.line.rests}
        applied = {int(rest) for rest in self.commands.rests}
        noisy = range(period) if self.motor_noise else ()
        self.segments = tuple(pairwise(sorted({0, period, *sampled, *applied, *noisy})))
        """The physics steps between two of which nothing but physics happens."""

    @property
    def noises(self) -> dict[str, DeviceNoise]:
        """The noise of each signal that has any."""
        noises = {name: sense.noise for name, sense in self.senses.items()} | {MOTOR: self.motor_noise}
        return {name: noise for name, noise in noises.items() if noise}

    def slots(self, clock: torch.Tensor) -> dict[Path, Slot]:
        """Return what infants remember, and the signals on their way at a time."""
        lines = {name: sense.line for name, sense in self.senses.items()} | {MOTOR: self.commands}
        memory = {name: in_place(values) for name, values in self.task.memory.items()}
        sent = {name: line.slot(clock) for name, line in lines.items()}
        deviations = {name: Slot(partial(getattr, line, "deviations"), line.deviate) for name, line in lines.items()}
        noise = {name: attribute(noise, "state") for name, noise in self.noises.items()}
        return {
            **dict(nested(memory, "task")),
            **dict(nested(sent, *HISTORY)),
            **dict(nested(deviations, "signals", "deviations")),
            **dict(nested(noise, "signals", "noise")),
            ("signals", "commanded"): in_place(self.commands.arrived),
        }

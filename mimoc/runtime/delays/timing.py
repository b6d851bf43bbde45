"""The time base of an infant: its signals on their way, by their delays in whole physics steps."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.units import to_steps
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.runtime.custom_sense import CustomSense
from mimoc.runtime.delays.signals import Delay, DelayedCommands, DelayedSamples, Mask
from mimoc.runtime.noise.noise import NoiseStreams
from mimoc.runtime.sense import IntArray, Sense
from mimoc.schema.delays import MOTOR, DelayEntry, DelaysEntry
from mimoc.schema.noise import NoiseEntry

NO_DELAY, NO_NOISE = DelayEntry(), NoiseEntry()
Within = Callable[[Sequence[str]], Mask]
"""Returns which of n numbers belong to some bodies or to what hangs on them, shape (n,)."""


def within(model: mujoco.MjModel, bodies: IntArray) -> Within:
    """Return what says which of n numbers, each of one of some bodies of a model, shape (n,), are in a part."""
    return lambda parts: in_subtrees(model, [model.body(part).id for part in parts])[bodies]


@dataclass(frozen=True, slots=True)
class Timing:
    """The time base of an infant, and the delays of its signals, with their jitter.

    Any of its methods raises a ValueError if a time is not a whole number of physics steps.
    """

    step_ms: float
    timestep_ms: float
    delays: Mapping[str, DelayEntry]
    """By sense, and under `motor` that of commands; a signal that is not named has none."""
    legs: Sequence[str] = ()
    """Bodies that the legs begin with, to and from which a delay can be longer."""
    noise: NoiseEntry = NO_NOISE
    """Noise of commands and senses, and jitter of the delays."""

    @property
    def period(self) -> int:
        """Physics steps in a control step."""
        return to_steps(self.step_ms, self.timestep_ms)

    def samples(self, sense: str, within: Within | None, streams: NoiseStreams) -> list[DelayedSamples]:
        """Return the samples of a sense on their way, by their delay; *within* says which of its n numbers are where.

        None is for a sense that is of no part of the body.
        """
        return [DelayedSamples(delay, self.period, part) for delay, part in self._of(sense, within, streams)]

    def commands(self, within: Within, actuators: IntArray, streams: NoiseStreams) -> list[DelayedCommands]:
        """Return the n commands on their way to some actuators, shape (n,), by their delay."""
        delayed = list[DelayedCommands]()
        for delay, part in self._of(MOTOR, within, streams):
            which = np.arange(len(actuators)) if part is None else np.flatnonzero(part)
            delayed.append(DelayedCommands(delay, self.period, which, actuators[which]))
        return delayed

    def further_commands(self, first: int, count: int, streams: NoiseStreams) -> list[DelayedCommands]:
        """Return some commands from the one with an index on, which move no joint, with the delay of commands."""
        part, numbers = np.arange(first, first + count), np.arange(count)
        return [DelayedCommands(delay, self.period, part, numbers) for delay, _ in self._of(MOTOR, None, streams)]

    def groups(self, signal: str, within: Within | None) -> list[tuple[str, int, Mask | None]]:
        """Return the delays of a signal: its name, physics steps, and the numbers that have this delay; None is all."""
        delay = self.delays.get(signal, NO_DELAY)
        parts = [(f"{signal}.{part.body}", part.ms, [part.body]) for part in delay.parts]
        if delay.legs_ms is not None:
            parts = [(f"{signal}.legs", delay.legs_ms, self.legs), *parts]
        groups: list[tuple[str, int, Mask | None]] = []
        left: Mask | None = None
        inside_of = [] if within is None else [(name, ms, within(bodies)) for name, ms, bodies in parts]
        for name, ms, mask in reversed(inside_of):  # Later parts are in earlier ones.
            inside = mask if left is None else mask & left
            if inside.any():
                groups.append((name, to_steps(ms, self.timestep_ms), inside))
                left = ~inside if left is None else left & ~inside
        return [(signal, to_steps(delay.ms, self.timestep_ms), left), *reversed(groups)]

    def delay_steps(self, signal: str, within: Within | None, count: int) -> IntArray:
        """Return the delay of each of some numbers of a signal in physics steps, shape (count,); see `groups`."""
        steps = np.zeros(count, np.intp)
        for _, late, part in self.groups(signal, within):
            steps[slice(None) if part is None else part] = late
        return steps

    def jitter(self, delay_steps: int) -> int:
        """Return by how many physics steps a delay of some varies at most: never by more than there are."""
        return min(to_steps(self.noise.delay_jitter_ms, self.timestep_ms), delay_steps)

    def _of(self, signal: str, within: Within | None, streams: NoiseStreams) -> list[tuple[Delay, Mask | None]]:
        """Return the delays of a signal, with the numbers that have them; see `groups`."""
        return [
            (Delay(late, self.jitter(late), streams, f"jitter.{name}"), part)
            for name, late, part in self.groups(signal, within)
        ]


def delays_by_signal(entry: DelaysEntry) -> Mapping[str, DelayEntry]:
    """Return the delays of a manifest by sense, and under `motor` that of commands."""
    return {name: delay for name, delay in entry if isinstance(delay, DelayEntry)}


def timing_of(manifest: Manifest, senses: Mapping[str, Sense]) -> Timing:
    """Return the time base, the noise, and the delays of an infant's signals and of senses passed as objects."""
    custom = {name: sense.delay for name, sense in senses.items() if isinstance(sense, CustomSense)}
    delays = {**delays_by_signal(manifest.delays), **custom}
    return Timing(manifest.step_ms, manifest.timestep_ms, delays, manifest.delays.legs, manifest.noise)

"""The time base of an infant: its signals on their way, by their delays in whole physics steps."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mimoc.base.units import to_steps
from mimoc.bundle.manifest import Manifest
from mimoc.delays.jittered import DelayRandomWalk, JitteredCommands, JitteredSamples
from mimoc.delays.signals import DelayedCommands, DelayedSamples, Mask
from mimoc.delays.spec import MOTOR, DelayEntry
from mimoc.noise.noise import NoiseStreams
from mimoc.noise.spec import NoiseEntry
from mimoc.senses.custom import CustomSense
from mimoc.senses.sense import IntArray, Sense

NO_DELAY, NO_NOISE = DelayEntry(), NoiseEntry()
Samples = DelayedSamples | JitteredSamples
Commands = DelayedCommands | JitteredCommands


@dataclass(frozen=True, slots=True)
class Timing:
    """The time base of an infant, and the delays of its signals, with their jitter.

    Any of its methods raises a ValueError if a time is not a whole number of physics steps.
    """

    step_ms: float
    """Control step."""
    timestep_ms: float
    """Physics step."""
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

    def samples(self, sense: str, in_legs: Mask | None, streams: NoiseStreams) -> list[Samples]:
        """Return the samples of a sense on their way, by their delay.

        Of its n numbers, those *in_legs* belong to the legs, shape (n,); None where none does.
        """
        return [
            JitteredSamples(steps, self.period, part, wander) if wander else DelayedSamples(steps, self.period, part)
            for steps, part, wander in self._jittered(sense, in_legs, streams)
        ]

    def commands(self, in_legs: Mask, actuators: IntArray, streams: NoiseStreams) -> list[Commands]:
        """Return the n commands on their way to some actuators, shape (n,), by their delay.

        Those *in_legs*, shape (n,), go to the legs.
        """
        delayed: list[Commands] = []
        for steps, part, wander in self._jittered(MOTOR, in_legs, streams):
            which = np.arange(len(actuators)) if part is None else np.flatnonzero(part)
            way = steps, self.period, which, actuators[which]
            delayed.append(JitteredCommands(*way, wander) if wander else DelayedCommands(*way))
        return delayed

    def groups(self, signal: str, in_legs: Mask | None) -> list[tuple[str, int, Mask | None]]:
        """Return the delays of a signal: its name, physics steps, and the numbers that have this delay; None is all.

        Raises:
            ValueError: If a delay is not a whole number of physics steps.
        """
        delay = self.delays.get(signal, NO_DELAY)
        groups: list[tuple[str, float, Mask | None]] = [(signal, delay.ms, None)]
        if delay.legs_ms is not None and in_legs is not None:
            groups = [(signal, delay.ms, ~in_legs), (f"{signal}.legs", delay.legs_ms, in_legs)]
        return [(name, to_steps(ms, self.timestep_ms), part) for name, ms, part in groups]

    def jitter(self, delay_steps: int) -> int:
        """Return by how many physics steps a delay of some varies at most: never by more than there are."""
        return min(to_steps(self.noise.delay_jitter_ms, self.timestep_ms), delay_steps)

    def _jittered(
        self, signal: str, in_legs: Mask | None, streams: NoiseStreams
    ) -> list[tuple[int, Mask | None, DelayRandomWalk | None]]:
        """Return the delays of a signal in physics steps, the numbers that have them, and the jitter; see `groups`."""
        return [
            (late, part, DelayRandomWalk(most, streams, f"jitter.{name}") if (most := self.jitter(late)) else None)
            for name, late, part in self.groups(signal, in_legs)
        ]


def timing_of(manifest: Manifest, senses: Mapping[str, Sense]) -> Timing:
    """Return the time base, the noise, and the delays of an infant's signals and of senses passed as objects."""
    delays = {name: delay for name, delay in manifest.delays if name != "legs"}
    custom = {name: sense.delay for name, sense in senses.items() if isinstance(sense, CustomSense)}
    return Timing(manifest.step_ms, manifest.timestep_ms, delays | custom, manifest.delays.legs, manifest.noise)

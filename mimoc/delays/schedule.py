"""The control step of an infant: commands applied and senses sampled with their delays, in whole physics steps."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.actuation.binding import Actuation
from mimoc.bundle.model import in_subtrees
from mimoc.delays.jittered import JitteredCommands, JitteredSamples
from mimoc.delays.signals import DelayedCommands, DelayedSamples, Mask
from mimoc.delays.spec import MOTOR, DelayEntry
from mimoc.noise.motor import MotorNoise
from mimoc.noise.senses import noisy
from mimoc.noise.spec import NoiseEntry
from mimoc.noise.streams import NoiseStreams
from mimoc.noise.wander import Wander
from mimoc.senses.sense import IntArray, Observation, Sample, Sense
from mimoc.units import ms_to_s, to_steps

NO_DELAY, NO_NOISE = DelayEntry(), NoiseEntry()
Samples = DelayedSamples | JitteredSamples
Commands = DelayedCommands | JitteredCommands
Read = Callable[[mujoco.MjData], Sample]
"""A sense, or one with noise: what returns its sample at a physics step."""


@dataclass(frozen=True, slots=True)
class Timing:
    """The time base of an infant, and the delays of its signals."""

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
        """Physics steps in a control step.

        Raises:
            ValueError: If it is not a whole number.
        """
        return to_steps(self.step_ms, self.timestep_ms)

    def samples(self, sense: str, in_legs: Mask | None, streams: NoiseStreams) -> list[Samples]:
        """Return the samples of a sense on their way, by their delay.

        Args:
            sense: The sense.
            in_legs: Which of its numbers belong to the legs, shape (n,); None where none does.
            streams: Random numbers of the jitter.

        Raises:
            ValueError: If a delay is not a whole number of physics steps.
        """
        return [
            JitteredSamples(steps, self.period, part, wander) if wander else DelayedSamples(steps, self.period, part)
            for steps, part, wander in self._groups(sense, in_legs, streams)
        ]

    def commands(self, in_legs: Mask, actuators: IntArray, streams: NoiseStreams) -> list[Commands]:
        """Return the commands on their way, by their delay.

        Args:
            in_legs: Which of the n commands go to the legs, shape (n,).
            actuators: The actuators of the model that they control, shape (n,).
            streams: Random numbers of the jitter.

        Raises:
            ValueError: If a delay is not a whole number of physics steps.
        """
        found: list[Commands] = []
        for steps, part, wander in self._groups(MOTOR, in_legs, streams):
            which = np.arange(len(actuators)) if part is None else np.flatnonzero(part)
            way = steps, self.period, which, actuators[which]
            found.append(JitteredCommands(*way, wander) if wander else DelayedCommands(*way))
        return found

    def _groups(
        self, signal: str, in_legs: Mask | None, streams: NoiseStreams
    ) -> list[tuple[int, Mask | None, Wander | None]]:
        """Return the delays of a signal in physics steps, with the numbers that have it (None is all) and its jitter.

        Raises:
            ValueError: If a delay is not a whole number of physics steps.
        """
        delay, jitter = self.delays.get(signal, NO_DELAY), to_steps(self.noise.delay_jitter_ms, self.timestep_ms)
        groups = [(signal, delay.ms, None)]
        if delay.legs_ms is not None and in_legs is not None:
            groups = [(signal, delay.ms, ~in_legs), (f"{signal}.legs", delay.legs_ms, in_legs)]
        steps = [to_steps(ms, self.timestep_ms) for _, ms, _ in groups]
        return [
            (late, part, Wander(most, streams, f"jitter.{name}") if (most := min(jitter, late)) else None)
            for late, (name, _, part) in zip(steps, groups, strict=True)
        ]


@dataclass(frozen=True)
class Segment:
    """A part of a control step: commands are applied, physics steps are made, senses are sampled."""

    commands: tuple[Commands, ...]
    physics_steps: int
    samples: tuple[tuple[Read, tuple[Samples, ...]], ...]
    """The senses to be sampled at the end, each once, with the delays that the sample goes into."""


class Schedule:
    """What happens when in a control step: it is cut into segments wherever a command arrives or a sense is sampled.

    It knows neither what is sensed nor how the infant is actuated: any `Sense` and any `Actuation` will do.
    """

    def __init__(
        self,
        senses: Mapping[str, Sense],
        actuation: Actuation,
        model: mujoco.MjModel,
        timing: Timing,
        streams: NoiseStreams | None = None,
    ):
        """Plan the control step, once.

        Args:
            senses: Senses that are bound to the model, by name.
            actuation: What turns an action into controls of the model.
            model: The model.
            timing: The time base, the delays and the noise.
            streams: Random numbers of the noise, if there is any.

        Raises:
            ValueError: If a delay, its jitter or the control step is not a whole number of physics steps.
        """
        streams = streams or NoiseStreams(0)
        self._model, self._senses, self._actuation, self._period = model, senses, actuation, timing.period
        in_legs = in_subtrees(model, [model.body(leg).id for leg in timing.legs])
        self._samples = {
            name: timing.samples(name, None if sense.bodies is None else in_legs[sense.bodies], streams)
            for name, sense in senses.items()
        }
        moved = model.jnt_bodyid[model.actuator_trnid[actuation.actuators, 0]]
        self._commands = timing.commands(in_legs[moved], actuation.actuators, streams)
        self._noisy = {
            name: found for name, sense in senses.items() if (found := noisy(name, sense, timing.noise, streams))
        }
        self._motor_noise = _motor_noise(timing, actuation, streams)
        self._reads: dict[str, Read] = {**senses, **self._noisy}
        self._jittered = [
            each for delayed in self._samples.values() for each in delayed if isinstance(each, JitteredSamples)
        ]
        is_jittered = self._jittered or any(isinstance(each, JitteredCommands) for each in self._commands)
        self._segments = None if is_jittered else self._cut()

    def reset(self, data: mujoco.MjData) -> None:
        """Forget all signals: the samples of now are observed until later ones arrive, and nothing is commanded."""
        if self._motor_noise:
            self._motor_noise.reset(data)
        for noise in self._noisy.values():
            noise.reset()
        for name, delayed in self._samples.items():
            sample = self._reads[name](data)
            for each in delayed:
                each.reset(sample)
        for commands in self._commands:
            commands.reset()

    def step(self, action: npt.ArrayLike, data: mujoco.MjData) -> None:
        """Go through one control step.

        Raises:
            ValueError: If the action is not one number for each actuator.
        """
        controls, noise = self._actuation(action), self._motor_noise
        commanded = noise.commanded if noise else data.ctrl
        for commands in self._commands:
            commands.begin(controls)
        for each in self._jittered:
            each.begin()
        for segment in self._segments or self._cut():
            for commands in segment.commands:
                commands.apply(commanded)
            if noise:
                noise(data)
            mujoco.mj_step(self._model, data, segment.physics_steps)
            for read, delayed in segment.samples:
                sample = read(data)
                for each in delayed:
                    each.send(sample)

    def observe(self) -> Observation:
        """Return the samples that have arrived as an observation of new arrays."""
        observation: Observation = {}
        for name, sense in self._senses.items():
            observation.update(sense.observe(_merged(self._samples[name])))
        return observation

    @property
    def state(self) -> dict[str, Any]:
        """The samples that have arrived, all signals on their way, and the noise."""
        return {
            "senses": {name: [each.state for each in delayed] for name, delayed in self._samples.items()},
            "commands": [commands.state for commands in self._commands],
            "noise": {name: noise.state for name, noise in self._noisy.items()},
            "motor_noise": self._motor_noise and self._motor_noise.state,
        }

    @state.setter
    def state(self, state: Mapping[str, Any]) -> None:
        for name, delayed in self._samples.items():
            for each, kept in zip(delayed, state["senses"][name], strict=True):
                each.state = kept
        for commands, kept in zip(self._commands, state["commands"], strict=True):
            commands.state = kept
        for name, noise in self._noisy.items():
            noise.state = state["noise"][name]
        if self._motor_noise:
            self._motor_noise.state = state["motor_noise"]

    def _cut(self) -> tuple[Segment, ...]:
        """Return the segments of a control step; noise of commands is drawn for each physics step."""
        sampled = {after for delayed in self._samples.values() for each in delayed for after in each.sampled_after}
        applied = {after for commands in self._commands for after in commands.applied_after}
        noisy = range(self._period) if self._motor_noise else ()
        cuts = sorted({0, self._period, *sampled, *applied, *noisy})
        return tuple(
            Segment(
                commands=tuple(commands for commands in self._commands if start in commands.applied_after),
                physics_steps=end - start,
                samples=tuple(
                    (self._reads[name], here)
                    for name, delayed in self._samples.items()
                    if (here := tuple(each for each in delayed if end in each.sampled_after))
                ),
            )
            for start, end in pairwise(cuts)
        )


def _motor_noise(timing: Timing, actuation: Actuation, streams: NoiseStreams) -> MotorNoise | None:
    noise = timing.noise
    if not noise.motor:
        return None
    return MotorNoise(noise.motor, ms_to_s(noise.low_pass_ms), ms_to_s(timing.timestep_ms), actuation, streams)


def _merged(delayed: Sequence[Samples]) -> Sample:
    """Return what has arrived of all parts of a sense as one sample."""
    if len(delayed) == 1:
        return delayed[0].arrived
    merged = delayed[0].arrived.copy()
    for each in delayed[1:]:
        merged[each.part] = each.arrived[each.part]
    return merged

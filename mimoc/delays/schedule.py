"""The control step of an infant: commands applied and senses sampled with their delays, in whole physics steps."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.actuation.binding import Actuation
from mimoc.bundle.model import in_subtrees
from mimoc.delays.signals import DelayedCommands, DelayedSamples, Mask
from mimoc.delays.spec import MOTOR, DelayEntry
from mimoc.senses.sense import Observation, Sample, Sense
from mimoc.units import to_steps

NO_DELAY = DelayEntry()


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

    def groups(self, signal: str, in_legs: Mask | None) -> list[tuple[int, Mask | None]]:
        """Return the delays of a signal in physics steps, each with the numbers that have it; None is all.

        Args:
            signal: A sense, or `motor`.
            in_legs: Which numbers of the signal belong to the legs, shape (n,); None where none does.

        Raises:
            ValueError: If a delay is not a whole number of physics steps.
        """
        delay = self.delays.get(signal, NO_DELAY)
        steps = to_steps(delay.ms, self.timestep_ms)
        if delay.legs_ms is None or in_legs is None:
            return [(steps, None)]
        return [(steps, ~in_legs), (to_steps(delay.legs_ms, self.timestep_ms), in_legs)]


@dataclass(frozen=True)
class Segment:
    """A part of a control step: commands are applied, physics steps are made, senses are sampled."""

    commands: tuple[DelayedCommands, ...]
    physics_steps: int
    samples: tuple[tuple[Sense, tuple[DelayedSamples, ...]], ...]
    """The senses to be sampled at the end, each once, with the delays that the sample goes into."""


class Schedule:
    """What happens when in a control step: it is cut into segments wherever a command arrives or a sense is sampled.

    It knows neither what is sensed nor how the infant is actuated: any `Sense` and any `Actuation` will do.
    """

    def __init__(self, senses: Mapping[str, Sense], actuation: Actuation, model: mujoco.MjModel, timing: Timing):
        """Plan the control step, once.

        Args:
            senses: Senses that are bound to the model, by name.
            actuation: What turns an action into controls of the model.
            model: The model.
            timing: The time base and the delays.

        Raises:
            ValueError: If a delay or the control step is not a whole number of physics steps.
        """
        self._model, self._senses, self._actuation = model, senses, actuation
        period = to_steps(timing.step_ms, timing.timestep_ms)
        in_legs = in_subtrees(model, [model.body(leg).id for leg in timing.legs])
        self._samples = {
            name: [
                DelayedSamples(steps, period, part)
                for steps, part in timing.groups(name, None if sense.bodies is None else in_legs[sense.bodies])
            ]
            for name, sense in senses.items()
        }
        moved = model.jnt_bodyid[model.actuator_trnid[actuation.actuators, 0]]
        everything = np.ones(len(moved), bool)
        self._commands = [
            DelayedCommands(steps, period, np.flatnonzero(part), actuation.actuators[part])
            for steps, found in timing.groups(MOTOR, in_legs[moved])
            for part in [everything if found is None else found]
        ]
        self._segments = self._cut(period)

    def reset(self, data: mujoco.MjData) -> None:
        """Forget all signals: the samples of now are observed until later ones arrive, and nothing is commanded."""
        for name, delayed in self._samples.items():
            sample = self._senses[name](data)
            for each in delayed:
                each.reset(sample)
        for commands in self._commands:
            commands.reset()

    def step(self, action: npt.ArrayLike, data: mujoco.MjData) -> None:
        """Go through one control step.

        Raises:
            ValueError: If the action is not one number for each actuator.
        """
        controls = self._actuation(action)
        for segment in self._segments:
            for commands in segment.commands:
                commands.send(controls, data)
            mujoco.mj_step(self._model, data, segment.physics_steps)
            for sense, delayed in segment.samples:
                sample = sense(data)
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
        """The samples that have arrived, and all signals on their way."""
        return {
            "senses": {name: [each.state for each in delayed] for name, delayed in self._samples.items()},
            "commands": [commands.state for commands in self._commands],
        }

    @state.setter
    def state(self, state: Mapping[str, Any]) -> None:
        for name, delayed in self._samples.items():
            for each, kept in zip(delayed, state["senses"][name], strict=True):
                each.state = kept
        for commands, kept in zip(self._commands, state["commands"], strict=True):
            commands.state = kept

    def _cut(self, period: int) -> tuple[Segment, ...]:
        """Return the segments of a control step."""
        sampled = {each.sampled_after for delayed in self._samples.values() for each in delayed}
        cuts = sorted({0, period} | sampled | {commands.applied_after for commands in self._commands})
        return tuple(
            Segment(
                commands=tuple(commands for commands in self._commands if commands.applied_after == start),
                physics_steps=end - start,
                samples=tuple(
                    (self._senses[name], here)
                    for name, delayed in self._samples.items()
                    if (here := tuple(each for each in delayed if each.sampled_after == end))
                ),
            )
            for start, end in pairwise(cuts)
        )


def _merged(delayed: Sequence[DelayedSamples]) -> Sample:
    """Return what has arrived of all parts of a sense as one sample."""
    if len(delayed) == 1:
        return delayed[0].arrived
    merged = delayed[0].arrived.copy()
    for each in delayed[1:]:
        merged[each.part] = each.arrived[each.part]
    return merged

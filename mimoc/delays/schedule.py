"""The nerves of an infant: what it senses and what it commands, each on its way for a whole number of physics steps."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.actuation.binding import Actuation
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.delays.line import DelayLine
from mimoc.delays.spec import DelayEntry
from mimoc.senses.binding import Sense
from mimoc.senses.sense import FloatArray, IntArray, Observation, Reading
from mimoc.units import to_steps

Mask = npt.NDArray[np.bool_]

NO_DELAY = DelayEntry()


class Afferent:
    """The way of a sense, or of a part of it, to the observation."""

    def __init__(self, delay_steps: int, control_steps: int, part: Mask):
        """Make a way that takes so many physics steps.

        Args:
            delay_steps: How long it takes.
            control_steps: Physics steps in a control step.
            part: Which numbers of a reading come this way.
        """
        self.felt_after = control_steps - delay_steps % control_steps
        """Physics steps of a control step after which to feel: what is felt then arrives at the end of a later one."""
        self.part = part
        self._length = delay_steps // control_steps

    def rest(self, reading: Reading) -> None:
        """Let a reading arrive until a later one does."""
        self.arrived = reading
        self._line = DelayLine(self._length, reading)

    def feel(self, reading: Reading) -> None:
        """Send a reading on its way; an earlier one arrives."""
        self.arrived = self._line.shift(reading)

    @property
    def state(self) -> list[Reading]:
        """What has arrived, then what is on its way."""
        return [self.arrived, *self._line.held]

    @state.setter
    def state(self, readings: list[Reading]) -> None:
        self.arrived, *self._line.held = readings


class Efferent:
    """The way of commands to some actuators."""

    def __init__(self, delay_steps: int, control_steps: int, part: IntArray, actuators: IntArray):
        """Make a way that takes so many physics steps.

        Args:
            delay_steps: How long it takes.
            control_steps: Physics steps in a control step.
            part: Which of the commands go this way.
            actuators: Which actuators of the model these reach.
        """
        self.driven_after = delay_steps % control_steps
        """Physics steps of a control step after which commands arrive."""
        self._length = delay_steps // control_steps
        self._part, self._actuators = part, actuators

    def rest(self) -> None:
        """Leave the actuators as they are until a command arrives."""
        self._line: DelayLine[FloatArray | None] = DelayLine(self._length, None)

    def drive(self, controls: FloatArray, data: mujoco.MjData) -> None:
        """Send commands on their way; earlier ones arrive."""
        arrived = self._line.shift(controls)
        if arrived is not None:
            data.ctrl[self._actuators] = arrived[self._part]

    @property
    def state(self) -> list[FloatArray | None]:
        """What is on its way."""
        return self._line.held

    @state.setter
    def state(self, controls: list[FloatArray | None]) -> None:
        self._line.held = controls


@dataclass(frozen=True)
class Stage:
    """A part of a control step: commands arrive, physics goes on, senses feel."""

    efferents: tuple[Efferent, ...]
    physics_steps: int
    felt: tuple[tuple[Sense, tuple[Afferent, ...]], ...]
    """What is felt then, each sense once, and the ways its reading goes."""


class Nerves:
    """All ways of signals to and from an infant, and the control step that they cut into stages."""

    def __init__(self, manifest: Manifest, senses: Mapping[str, Sense], actuation: Actuation, model: mujoco.MjModel):
        """Lay the ways of senses and commands, once."""
        self._model, self._senses, self._actuation = model, senses, actuation
        period = to_steps(manifest.step_ms, manifest.timestep_ms)
        delays, in_legs = (
            dict(manifest.delays),
            in_subtrees(model, [model.body(leg).id for leg in manifest.delays.legs]),
        )
        self._afferents = {
            name: [
                Afferent(steps, period, part)
                for steps, part in _ways(delays.get(name, NO_DELAY), manifest.timestep_ms, in_legs[sense.bodies])
            ]
            for name, sense in senses.items()
        }
        moved = model.jnt_bodyid[model.actuator_trnid[actuation.actuators, 0]]
        self._efferents = [
            Efferent(steps, period, np.flatnonzero(part), actuation.actuators[part])
            for steps, part in _ways(manifest.delays.motor, manifest.timestep_ms, in_legs[moved])
        ]
        self._stages = self._cut(period)

    def rest(self, data: mujoco.MjData) -> Observation:
        """Start anew: what is felt now is all that is felt until later readings arrive, and nothing is commanded."""
        for name, afferents in self._afferents.items():
            reading = self._senses[name](data)
            for afferent in afferents:
                afferent.rest(reading)
        for efferent in self._efferents:
            efferent.rest()
        return self.observe()

    def step(self, action: npt.ArrayLike, data: mujoco.MjData) -> None:
        """Go through one control step.

        Raises:
            ValueError: If the action is not one number for each actuator.
        """
        controls = self._actuation(action)
        for stage in self._stages:
            for efferent in stage.efferents:
                efferent.drive(controls, data)
            mujoco.mj_step(self._model, data, stage.physics_steps)
            for sense, afferents in stage.felt:
                reading = sense(data)
                for afferent in afferents:
                    afferent.feel(reading)

    def observe(self) -> Observation:
        """Return what has arrived, as fresh arrays."""
        observation: Observation = {}
        for name, sense in self._senses.items():
            observation.update(sense.observe(_merged(self._afferents[name])))
        return observation

    @property
    def state(self) -> dict[str, Any]:
        """What has arrived and what is on its way."""
        return {
            "senses": {name: [way.state for way in ways] for name, ways in self._afferents.items()},
            "commands": [way.state for way in self._efferents],
        }

    @state.setter
    def state(self, state: Mapping[str, Any]) -> None:
        for name, ways in self._afferents.items():
            for way, held in zip(ways, state["senses"][name], strict=True):
                way.state = held
        for way, held in zip(self._efferents, state["commands"], strict=True):
            way.state = held

    def _cut(self, period: int) -> tuple[Stage, ...]:
        """Return the stages of a control step: it is cut wherever a command arrives or something is felt."""
        felt = {way.felt_after for ways in self._afferents.values() for way in ways}
        cuts = sorted({0, period} | felt | {way.driven_after for way in self._efferents})
        return tuple(
            Stage(
                efferents=tuple(way for way in self._efferents if way.driven_after == start),
                physics_steps=end - start,
                felt=tuple(
                    (self._senses[name], here)
                    for name, ways in self._afferents.items()
                    if (here := tuple(way for way in ways if way.felt_after == end))
                ),
            )
            for start, end in pairwise(cuts)
        )


def _ways(delay: DelayEntry, timestep_ms: float, in_legs: Mask) -> list[tuple[int, Mask]]:
    """Return the ways that signals take: physics steps, and which of the signals, shape (n,)."""
    if delay.legs_ms is None:
        return [(to_steps(delay.ms, timestep_ms), np.ones_like(in_legs))]
    return [(to_steps(delay.ms, timestep_ms), ~in_legs), (to_steps(delay.legs_ms, timestep_ms), in_legs)]


def _merged(ways: Sequence[Afferent]) -> Reading:
    """Return what has arrived on all ways of a sense as one reading."""
    if len(ways) == 1:
        return ways[0].arrived
    merged = ways[0].arrived.copy()
    for way in ways[1:]:
        merged[way.part] = way.arrived[way.part]
    return merged

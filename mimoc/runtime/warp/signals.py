"""The senses of all infants on a device: reading, noise, delay lines and observations."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.spaces import Box, Dict

from mimoc.bundle.model import in_subtrees
from mimoc.delays.spec import MOTOR
from mimoc.delays.timing import NO_DELAY
from mimoc.kinds import Code, function_of
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.timing import timing_of
from mimoc.runtime.warp.device_worlds import device_worlds, put_on, term_of_worlds
from mimoc.runtime.warp.lines import Line
from mimoc.runtime.warp.noise import DeviceNoise
from mimoc.senses import SENSES
from mimoc.senses.custom import CustomSense
from mimoc.senses.sense import IntArray, Sense
from mimoc.units import ms_to_s, to_steps


@dataclass(frozen=True)
class DeviceSetup:
    """What the device part of a sense is bound to: the different bodies, and which of them lives in each world."""

    infants: Sequence[InfantEnv]
    """Single environments of the different bodies."""
    body: wp.array
    """The body that lives in each world, shape (worlds,)."""
    model: mjw.Model
    """That of all worlds."""
    touch: str
    """How touch is told: the option of the environment."""


class DeviceReader(Protocol):
    """Reads a sense of all infants; one that differs from the sense on the CPU can have `spaces` and `bodies` too."""

    def __call__(self, model: mjw.Model, data: mjw.Data, sample: wp.array) -> None:
        """Write what is sensed now, shape (worlds, n)."""
        ...


class TermReader:
    """Reads a sense that is a term."""

    def __init__(self, name: str, setup: DeviceSetup):
        """Stack the terms of the different bodies, by the body that lives in each world; see `term_of_worlds`."""
        terms: list[Any] = [infant.senses[name].term for infant in setup.infants]
        self._term = term_of_worlds(f"sense '{name}'", terms, setup.body)
        self._data: mjw.Data | None = None

    def __call__(self, model: mjw.Model, data: mjw.Data, sample: wp.array) -> None:
        """Write what is sensed now, shape (worlds, n)."""
        if data is not self._data:
            self._data, self._worlds = data, device_worlds(data)
        wp.to_torch(sample).copy_(self._term(self._worlds).reshape(sample.shape))


class DeviceSense:
    """A sense of all infants."""

    def __init__(self, name: str, setup: DeviceSetup, read: DeviceReader, noise: DeviceNoise | None):
        """Set up the delays; *noise* is added to what *read* reads, if there is any."""
        self.name, self.read, self._noise = name, read, noise
        infants, manifest = setup.infants, setup.infants[0].manifest
        self._timestep_s, self._period = ms_to_s(manifest.timestep_ms), round(manifest.step_ms / manifest.timestep_ms)
        self.spaces: list[Mapping[str, Box]] = [
            getattr(read, "spaces", infant.senses[name].spaces) for infant in infants
        ]
        """What each of the different bodies observes."""
        boxes = list(self.spaces[0].values())
        self._sizes = [int(np.prod(box.shape)) for box in boxes]
        self._is_picture = boxes[0].dtype == np.uint8 and not isinstance(read, TermReader)
        delays = np.stack([delays_of(infant, name, sum(self._sizes), read) for infant in infants])
        self.line = Line(delays, self._period, setup.body, wp.uint8 if self._is_picture else wp.float32)
        put, body = put_on(setup.body.device), wp.to_torch(setup.body).long()
        bounds = [np.stack([_bound(spaces, which) for spaces in self.spaces]) for which in ("low", "high")]
        self._bounds = [put(rows[:1]) if (rows == rows[:1]).all() else put(rows)[body] for rows in bounds]

    def sample(self, model: mjw.Model, data: mjw.Data, clock: torch.Tensor, rest: int) -> None:
        """Read what arrives *rest* physics steps less than whole control steps later, if anything does."""
        if rest not in self.line.rests:
            return
        self.read(model, data, self.line.entering)
        if self._noise:
            earlier = min((other - rest) % self._period or self._period for other in self.line.rests)
            entering = wp.to_torch(self.line.entering)
            entering.copy_(self._noise(entering, float(earlier) * self._timestep_s))
        self.line.send(clock, rest)

    def arrive(self, clock: torch.Tensor, observation: Mapping[str, wp.array]) -> None:
        """Write what has arrived, within its bounds, to its arrays in the observation."""
        arrived = torch.empty_like(wp.to_torch(self.line.entering))
        for _, columns, values in self.line.arrive(clock):
            arrived[:, columns] = values
        if not self._is_picture:
            torch.clamp(arrived.nan_to_num_(0.0, math.inf, -math.inf), *self._bounds, out=arrived)
        for name, values in zip(self.spaces[0], arrived.split(self._sizes, dim=1), strict=True):
            wp.to_torch(observation[name]).copy_(values.reshape(observation[name].shape))

    def refill(self, chosen: wp.array, samples: Mapping[str, wp.array]) -> None:
        """Forget what is on the way in worlds that begin with one of some starts; see what is sensed at these.

        Noise is drawn anew.
        """
        start, begin = wp.to_torch(chosen), wp.to_torch(chosen) >= 0
        sample = wp.to_torch(samples[self.name])[start.clamp(min=0).long()]
        self.line.fill(begin, self._noise.begin(sample, begin) if self._noise else sample)


def device_part(name: str, sense: Sense) -> Code | None:
    """Return what reads a sense on a device in place of a term, if there is anything."""
    return SENSES[name].device if name in SENSES and not isinstance(sense, CustomSense) else None


def reader_of(name: str, setup: DeviceSetup) -> DeviceReader:
    """Return what reads a sense of all infants."""
    device = device_part(name, setup.infants[0].senses[name])
    return function_of(device, "bind")(setup) if device else TermReader(name, setup)


def delays_of(infant: InfantEnv, signal: str, count: int, read: DeviceReader | None = None) -> IntArray:
    """Return the delay of each of n numbers of a signal of an infant, shape (n,), in physics steps."""
    model, timing = infant.model, timing_of(infant.manifest, infant.senses)
    if signal == MOTOR:
        bodies: Any = model.jnt_bodyid[model.actuator_trnid[infant.actuation.actuators, 0]]
    else:
        bodies = getattr(read, "bodies", infant.senses[signal].bodies)
    delay = timing.delays.get(signal, NO_DELAY)
    steps = np.full(count, to_steps(delay.ms, timing.timestep_ms))
    if delay.legs_ms is not None and bodies is not None:
        in_legs = in_subtrees(model, [model.body(leg).id for leg in timing.legs])[bodies]
        steps[in_legs.repeat(count // len(bodies))] = to_steps(delay.legs_ms, timing.timestep_ms)
    return steps


def space_of(infant: InfantEnv, senses: Mapping[str, DeviceSense], body: int) -> Dict:
    """Return what an infant observes here; it differs from the CPU where touch is told by bodies."""
    spaces: Mapping[str, Any] = infant.observation_space.spaces
    return Dict({**spaces, **{name: box for sense in senses.values() for name, box in sense.spaces[body].items()}})


def _bound(spaces: Mapping[str, Box], which: str) -> Any:
    return np.concatenate([getattr(box, which).ravel().astype(np.float64) for box in spaces.values()])

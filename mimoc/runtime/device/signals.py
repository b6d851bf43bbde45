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

from mimoc.base.errors import MimocError
from mimoc.base.kinds import Code, function_of
from mimoc.base.units import ms_to_s, to_steps
from mimoc.runtime.delays.signals import timing_of, within
from mimoc.runtime.device.arrays import put, term_of_worlds
from mimoc.runtime.device.lines import DelayLine, Delays
from mimoc.runtime.device.noise import CounterRandom, noise_of
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import IntArray, Sense
from mimoc.runtime.senses import CustomSense
from mimoc.runtime.worlds import Worlds
from mimoc.schema.kinds import SENSES
from mimoc.schema.senses import MOTOR


@dataclass(frozen=True)
class DeviceSetup:
    """What the device part of a sense is bound to: the different bodies, and which of them lives in each world."""

    infants: Sequence[InfantEnv]
    body: torch.Tensor  # The body that lives in each world, shape (worlds,).
    model: mjw.Model
    touch: str  # How touch is told: the option of the environment.


class DeviceReader(Protocol):
    """Reads a sense of all infants; what it tells may differ from the CPU: it has `spaces`, `bodies` and `start` then.

    `start(sample)` returns what it tells of a sample of the CPU, shape (n,).
    """

    def __call__(self, data: mjw.Data) -> torch.Tensor:
        """Return what is sensed now, shape (worlds, n), in memory that the next call may write to."""
        ...


class DeviceSense:
    """A sense of all infants."""

    def __init__(self, name: str, setup: DeviceSetup, chance: CounterRandom):
        """Set up what reads it, its delays, and its noise, which draws from *chance*."""
        infants, body, manifest = setup.infants, setup.body, setup.infants[0].manifest
        device = device_part(name, infants[0].senses[name])
        self.reader: DeviceReader | None = function_of(device, "bind")(setup) if device else None
        """What reads it if it is no term."""
        terms: list[Any] = [infant.senses[name].term for infant in infants]
        self._term: Any = None if device else term_of_worlds(f"sense '{name}'", terms, body)
        self.noise = noise_of(name, infants, body, chance)
        self._timestep_s, self._period = ms_to_s(manifest.timestep_ms), round(manifest.step_ms / manifest.timestep_ms)
        self.spaces: list[Mapping[str, Box]] = [
            getattr(self.reader, "spaces", infant.senses[name].spaces) for infant in infants
        ]
        """What each of the different bodies observes."""
        boxes = list(self.spaces[0].values())
        self._sizes = [int(np.prod(box.shape)) for box in boxes]
        self._is_picture = boxes[0].dtype == np.uint8 and device is not None
        bodies = [getattr(self.reader, "bodies", infant.senses[name].bodies) for infant in infants]
        self.line = line_of(name, setup, sum(self._sizes), chance, bodies, self._is_picture)
        bounds = [np.stack([_bound(spaces, which) for spaces in self.spaces]) for which in ("low", "high")]
        self._bounds = [put(rows[:1]) if (rows == rows[:1]).all() else put(rows)[body] for rows in bounds]

    def sample(self, worlds: Worlds, clock: torch.Tensor, rest: int) -> None:
        """Read what arrives *rest* physics steps less than whole control steps later, if anything does."""
        if rest not in self.line.rests:
            return
        sample = self.reader(worlds.datas[0]) if self.reader else self._term(worlds).flatten(1)
        if self.noise:
            earlier = min((other - rest) % self._period or self._period for other in self.line.rests)
            sample = self.noise(sample, float(earlier) * self._timestep_s)
        self.line.send(clock, sample, rest)

    def arrive(self, clock: torch.Tensor, observation: Mapping[str, torch.Tensor]) -> None:
        """Write what has arrived, within its bounds, to its arrays in the observation."""
        arrived = self.line.receive(clock)
        if not self._is_picture:
            torch.clamp(arrived.nan_to_num_(0.0, math.inf, -math.inf), *self._bounds, out=arrived)
        for name, values in zip(self.spaces[0], arrived.split(self._sizes, dim=1), strict=True):
            observation[name].copy_(values.view(observation[name].shape))

    def refill(self, sample: torch.Tensor, begin: torch.Tensor) -> None:
        """Forget what is on the way in worlds that begin, shape (worlds,), with samples; noise is drawn anew."""
        self.line.fill(begin, self.noise.begin(sample, begin) if self.noise else sample)


def device_part(name: str, sense: Sense) -> Code | None:
    """Return what reads a sense on a device in place of a term, if there is anything."""
    return SENSES[name].device if name in SENSES and not isinstance(sense, CustomSense) else None


def line_of(
    signal: str,
    setup: DeviceSetup,
    count: int,
    chance: CounterRandom,
    bodies: Sequence[IntArray | None],
    is_picture: bool = False,
) -> DelayLine:
    """Return the delay line of a signal of all infants; see `delays_of`."""
    infants, manifest = setup.infants, setup.infants[0].manifest
    delays = [delays_of(infant, signal, count, where) for infant, where in zip(infants, bodies, strict=True)]
    together = Delays(*map(np.stack, zip(*delays, strict=True)))
    kind, period = torch.uint8 if is_picture else torch.float32, to_steps(manifest.step_ms, manifest.timestep_ms)
    uniforms = chance.uniforms_of([*infants[0].senses, MOTOR].index(signal))
    return DelayLine(together, period, setup.body, uniforms, signal == MOTOR, kind)


def delays_of(infant: InfantEnv, signal: str, count: int, bodies: IntArray | None = None) -> Delays:
    """Return the delay of each of n numbers of a signal of an infant, and how it varies.

    A sense measures equally many numbers in each of *bodies*; None if none is in the legs.
    """
    model, timing = infant.model, timing_of(infant.manifest, infant.senses)
    if signal == MOTOR:
        bodies = model.jnt_bodyid[model.actuator_trnid[infant.actuation.actuators, 0]]
    where = None if bodies is None else within(model, bodies.repeat(count // len(bodies)))
    delays = Delays(*np.zeros((len(Delays._fields), count), np.intp))
    for channel, (_, late, part) in enumerate(timing.groups(signal, where)):
        for values, value in zip(delays, (late, timing.jitter(late), channel), strict=True):
            values[... if part is None else part] = value
    return delays


def space_of(infant: InfantEnv, senses: Mapping[str, DeviceSense], body: int) -> Dict:
    """Return what an infant observes here; it differs from the CPU where touch is told by bodies."""
    spaces: Mapping[str, Any] = infant.observation_space.spaces
    return Dict({**spaces, **{name: box for sense in senses.values() for name, box in sense.spaces[body].items()}})


def _bound(spaces: Mapping[str, Box], which: str) -> Any:
    return np.concatenate([getattr(box, which).ravel().astype(np.float64) for box in spaces.values()])


class DeviceError(MimocError):
    """Infants cannot live on a device, or what they do there went wrong."""


def find_device(name: str) -> Any:
    """Return one of Warp's devices."""
    try:
        return wp.get_device(name)
    except (ValueError, RuntimeError):
        devices = ", ".join(device.alias for device in wp.get_devices())
        none = "" if wp.is_cuda_available() else " and no NVIDIA GPU with its driver"
        raise DeviceError(f"device '{name}' is not there; MuJoCo Warp finds {devices}{none} on this machine") from None


def check_infant(infant: InfantEnv) -> None:
    """Check that all that an infant has can run on a device, whoever wrote it: what cannot must not be ignored."""
    for name in infant.companions:
        raise DeviceError(f"companion '{name}' acts on the CPU only: leave it out, or leave out device")
    if infant.manifest.actuation.voice:
        raise DeviceError("a voice sounds on the CPU only: leave actuation.voice out, or leave out device")
    for sense, bound in infant.senses.items():
        if bound.term is None and not device_part(sense, bound):
            raise DeviceError(
                f"sense '{sense}' is not a term and has no device part: give it one (docs/own_sense.md), or leave out "
                "device"
            )

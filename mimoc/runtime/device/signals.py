"""The senses of all infants on a device: reading, noise, delay lines and observations.

What is sampled or commanded now arrives later, for each number and infant after its delay. A delay line is a ring of
slots, one for each control step that the longest delay of any infant takes and one more: with a delay of L control
steps, what was sent L steps ago is in slot (clock - L) modulo (L + 1), which is the next to be written. So a reset only
fills all slots. With L = 2:

    clock      0   1   2   3   4
    sent to    0   1   2   0   1
    arrives    -   -   0   1   2      what was sent at clock 0, 1, 2
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.spaces import Box, Dict

from mimoc.base.errors import MimocError
from mimoc.base.kinds import Code, function_of
from mimoc.base.units import ms_to_s, to_steps
from mimoc.bundle.model import in_subtrees
from mimoc.delays.signals import Mask
from mimoc.delays.spec import MOTOR
from mimoc.delays.timing import NO_DELAY
from mimoc.runtime.device.arrays import device_worlds, put_on, term_of_worlds
from mimoc.runtime.device.noise import CounterRandom, noise_of
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.timing import timing_of
from mimoc.senses import SENSES
from mimoc.senses.custom import CustomSense
from mimoc.senses.sense import IntArray, Sense

Rows = torch.Tensor | slice


class Part(NamedTuple):
    """Numbers of a signal that have the same delay as each other in every infant."""

    columns: Rows
    slots: torch.Tensor
    """One more than the whole control steps of the delay, shape (worlds,)."""
    worlds_by_rest: dict[int, Rows]
    """The worlds whose delay takes some physics steps more."""
    ring: torch.Tensor
    """What is on its way, shape (slots, worlds, columns)."""


class Line:
    """What is on its way of one signal of all infants."""

    def __init__(self, delays: IntArray, period: int, body_of_world: wp.array, dtype: torch.dtype = torch.float32):
        """Begin with nothing on the way.

        Args:
            delays: In physics steps, shape (bodies, n).
            period: Physics steps in a control step.
            body_of_world: Which body lives in each world, shape (worlds,).
            dtype: Of the numbers.
        """
        body = body_of_world.numpy()
        self.rests: IntArray = np.unique(delays % period)
        """By how many physics steps delays are longer than whole control steps."""
        device = wp.device_to_torch(body_of_world.device)
        self._worlds = torch.arange(len(body), device=device)
        self._parts: list[Part] = []
        for delay in np.unique(delays, axis=1).T:
            slots, rests = delay[body] // period + 1, delay[body] % period
            mask = (delays == delay[:, None]).all(axis=0)
            ring = torch.zeros((int(slots.max()), len(body), int(mask.sum())), dtype=dtype, device=device)
            worlds_by_rest = {int(rest): _rows(rests == rest, device) for rest in np.unique(rests)}
            self._parts.append(Part(_rows(mask, device), torch.as_tensor(slots, device=device), worlds_by_rest, ring))

    def send(self, clock: torch.Tensor, values: torch.Tensor, rest: int | None = None) -> None:
        """Send values, shape (worlds, n), or those whose delay is *rest* physics steps over whole control steps."""
        for part, rows in self._due(rest):
            slots = (clock % part.slots)[rows]
            part.ring[slots, self._worlds[rows]] = values[:, part.columns][rows]

    def arrive(self, clock: torch.Tensor, rest: int | None = None) -> Iterator[tuple[Rows, Rows, torch.Tensor]]:
        """Yield worlds, columns, and what has arrived there; of those numbers that `send` sends."""
        for part, rows in self._due(rest):
            slots = ((clock + 1) % part.slots)[rows]
            yield rows, part.columns, part.ring[slots, self._worlds[rows]]

    def fill(self, begin: torch.Tensor, start: torch.Tensor) -> None:
        """Forget all that is on the way in worlds that begin, shape (worlds,); rows of *start* come out until then."""
        for part in self._parts:
            torch.where(begin[:, None], start[:, part.columns], part.ring, out=part.ring)

    def _due(self, rest: int | None) -> Iterator[tuple[Part, Rows]]:
        for part in self._parts:
            if rest is None:
                yield part, slice(None)
            elif rest in part.worlds_by_rest:
                yield part, part.worlds_by_rest[rest]


def _rows(mask: Mask, device: torch.device) -> Rows:
    """Return where a mask is true, as a slice if it is everywhere."""
    return slice(None) if mask.all() else torch.as_tensor(np.flatnonzero(mask), device=device)


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

    def __call__(self, data: mjw.Data) -> torch.Tensor:
        """Return what is sensed now, shape (worlds, n), in memory that the next call may write to."""
        ...


class TermReader:
    """Reads a sense that is a term."""

    def __init__(self, name: str, setup: DeviceSetup):
        """Stack the terms of the different bodies, by the body that lives in each world; see `term_of_worlds`."""
        terms: list[Any] = [infant.senses[name].term for infant in setup.infants]
        self._term = term_of_worlds(f"sense '{name}'", terms, setup.body)
        self._data: mjw.Data | None = None

    def __call__(self, data: mjw.Data) -> torch.Tensor:
        """Return what is sensed now, shape (worlds, n)."""
        if data is not self._data:
            self._data, self._worlds = data, device_worlds(data)
        return self._term(self._worlds).flatten(1)


class DeviceSense:
    """A sense of all infants."""

    def __init__(self, name: str, setup: DeviceSetup, chance: CounterRandom):
        """Set up what reads it, its delays, and its noise, which draws from *chance*."""
        device = device_part(name, setup.infants[0].senses[name])
        self.read: DeviceReader = function_of(device, "bind")(setup) if device else TermReader(name, setup)
        self.name, self._count, self._noise = (
            name,
            setup.body.shape[0],
            noise_of(name, setup.infants, setup.body, chance),
        )
        infants, manifest = setup.infants, setup.infants[0].manifest
        self._timestep_s, self._period = ms_to_s(manifest.timestep_ms), round(manifest.step_ms / manifest.timestep_ms)
        self.spaces: list[Mapping[str, Box]] = [
            getattr(self.read, "spaces", infant.senses[name].spaces) for infant in infants
        ]
        """What each of the different bodies observes."""
        boxes = list(self.spaces[0].values())
        self._sizes = [int(np.prod(box.shape)) for box in boxes]
        is_picture = boxes[0].dtype == np.uint8 and device is not None
        self._dtype = torch.uint8 if is_picture else torch.float32
        delays = np.stack([delays_of(infant, name, sum(self._sizes), self.read) for infant in infants])
        self.line = Line(delays, self._period, setup.body, self._dtype)
        put, body = put_on(setup.body.device), wp.to_torch(setup.body).long()
        bounds = [np.stack([_bound(spaces, which) for spaces in self.spaces]) for which in ("low", "high")]
        self._bounds = [put(rows[:1]) if (rows == rows[:1]).all() else put(rows)[body] for rows in bounds]

    def sample(self, data: mjw.Data, clock: torch.Tensor, rest: int) -> None:
        """Read what arrives *rest* physics steps less than whole control steps later, if anything does."""
        if rest not in self.line.rests:
            return
        sample = self.read(data)
        if self._noise:
            earlier = min((other - rest) % self._period or self._period for other in self.line.rests)
            sample = self._noise(sample, float(earlier) * self._timestep_s)
        self.line.send(clock, sample.to(self._dtype), rest)

    def arrive(self, clock: torch.Tensor, observation: Mapping[str, wp.array]) -> None:
        """Write what has arrived, within its bounds, to its arrays in the observation."""
        arrived = torch.empty((self._count, sum(self._sizes)), dtype=self._dtype, device=clock.device)
        for _, columns, values in self.line.arrive(clock):
            arrived[:, columns] = values
        if self._dtype != torch.uint8:
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


class DeviceError(MimocError):
    """Infants cannot live on a device, or what they do there went wrong."""


def find_device(name: str) -> Any:
    """Return one of Warp's devices.

    Raises:
        DeviceError: If it is not there.
    """
    try:
        return wp.get_device(name)
    except (ValueError, RuntimeError):
        devices = ", ".join(device.alias for device in wp.get_devices())
        none = "" if wp.is_cuda_available() else " and no NVIDIA GPU with its driver"
        raise DeviceError(f"device '{name}' is not there; MuJoCo Warp finds {devices}{none} on this machine") from None


def check_infant(infant: InfantEnv) -> None:
    """Check that all that an infant has can run on a device, whoever wrote it: what cannot must not be ignored.

    Raises:
        DeviceError: If something cannot.
    """
    for sense, bound in infant.senses.items():
        if bound.term is None and not device_part(sense, bound):
            raise DeviceError(
                f"sense '{sense}' is not a term and has no device part: give it one (docs/own_sense.md), or leave out "
                "device"
            )
    if infant.manifest.noise.delay_jitter_ms:
        raise DeviceError(
            f"infant '{infant.manifest.name}' has delays with jitter, which are not there on a device; "
            "leave out delay_jitter_ms, or device"
        )

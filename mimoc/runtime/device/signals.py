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
from mimoc.base.units import ms_to_s
from mimoc.bundle.model import in_subtrees
from mimoc.delays.signals import Mask
from mimoc.delays.spec import MOTOR
from mimoc.delays.timing import timing_of
from mimoc.runtime.device.arrays import put, term_of_worlds
from mimoc.runtime.device.noise import CounterRandom, noise_of
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.worlds import Worlds
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

    def __init__(self, delays: IntArray, period: int, body: torch.Tensor, dtype: torch.dtype = torch.float32):
        """Begin with nothing on the way; delays and the control step are in physics steps, shape (bodies, n) and ()."""
        self.rests: IntArray = np.unique(delays % period)
        """By how many physics steps delays are longer than whole control steps."""
        self._worlds = torch.arange(len(body), device=body.device)
        self._parts: list[Part] = []
        for delay in np.unique(delays, axis=1).T:
            mask, of_world = (delays == delay[:, None]).all(axis=0), delay[body.tolist()]
            slots, rests = of_world // period + 1, of_world % period
            worlds_by_rest = {rest: _rows(rests == rest) for rest in np.unique(rests).tolist()}
            ring = torch.zeros((int(slots.max()), len(body), int(mask.sum())), dtype=dtype, device=body.device)
            self._parts.append(Part(_rows(mask), put(slots), worlds_by_rest, ring))
        self.arrived = torch.zeros((len(body), delays.shape[1]), dtype=dtype, device=body.device)
        """What has arrived, shape (worlds, n)."""

    def send(self, clock: torch.Tensor, values: torch.Tensor, rest: int | None = None) -> None:
        """Send values, shape (worlds, n), or those whose delay is *rest* physics steps over whole control steps."""
        for part, rows in self._due(rest):
            slots = (clock % part.slots)[rows]
            part.ring[slots, self._worlds[rows]] = values[:, part.columns][rows]

    def receive(self, clock: torch.Tensor, rest: int | None = None) -> torch.Tensor:
        """Return what has arrived, shape (worlds, n), where those numbers are new that `send` sends."""
        for part, rows in self._due(rest):
            slots = ((clock + 1) % part.slots)[rows]
            places = rows if isinstance(rows, slice) or isinstance(part.columns, slice) else rows[:, None]
            self.arrived[places, part.columns] = part.ring[slots, self._worlds[rows]]
        return self.arrived

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


def _rows(mask: Mask) -> Rows:
    """Return where a mask is true, as a slice if it is everywhere."""
    return slice(None) if mask.all() else put(np.flatnonzero(mask))


@dataclass(frozen=True)
class DeviceSetup:
    """What the device part of a sense is bound to: the different bodies, and which of them lives in each world."""

    infants: Sequence[InfantEnv]
    """Single environments of the different bodies."""
    body: torch.Tensor
    """The body that lives in each world, shape (worlds,)."""
    model: mjw.Model
    """That of all worlds."""
    touch: str
    """How touch is told: the option of the environment."""


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
        self._noise = noise_of(name, infants, body, chance)
        self._timestep_s, self._period = ms_to_s(manifest.timestep_ms), round(manifest.step_ms / manifest.timestep_ms)
        self.spaces: list[Mapping[str, Box]] = [
            getattr(self.reader, "spaces", infant.senses[name].spaces) for infant in infants
        ]
        """What each of the different bodies observes."""
        boxes = list(self.spaces[0].values())
        self._sizes = [int(np.prod(box.shape)) for box in boxes]
        self._is_picture = boxes[0].dtype == np.uint8 and device is not None
        delays = np.stack([self._delays(name, infant) for infant in infants])
        self.line = Line(delays, self._period, body, torch.uint8 if self._is_picture else torch.float32)
        bounds = [np.stack([_bound(spaces, which) for spaces in self.spaces]) for which in ("low", "high")]
        self._bounds = [put(rows[:1]) if (rows == rows[:1]).all() else put(rows)[body] for rows in bounds]

    def _delays(self, name: str, infant: InfantEnv) -> IntArray:
        return delays_of(infant, name, sum(self._sizes), getattr(self.reader, "bodies", infant.senses[name].bodies))

    def sample(self, worlds: Worlds, clock: torch.Tensor, rest: int) -> None:
        """Read what arrives *rest* physics steps less than whole control steps later, if anything does."""
        if rest not in self.line.rests:
            return
        sample = self.reader(worlds.datas[0]) if self.reader else self._term(worlds).flatten(1)
        if self._noise:
            earlier = min((other - rest) % self._period or self._period for other in self.line.rests)
            sample = self._noise(sample, float(earlier) * self._timestep_s)
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
        self.line.fill(begin, self._noise.begin(sample, begin) if self._noise else sample)


def device_part(name: str, sense: Sense) -> Code | None:
    """Return what reads a sense on a device in place of a term, if there is anything."""
    return SENSES[name].device if name in SENSES and not isinstance(sense, CustomSense) else None


def delays_of(infant: InfantEnv, signal: str, count: int, bodies: IntArray | None = None) -> IntArray:
    """Return the delay of each of n numbers of a signal of an infant, shape (n,), in physics steps.

    Args:
        infant: The infant.
        signal: A sense, or the commands.
        count: How many numbers it has.
        bodies: Those in which a sense measures them, of which each measures as many; None if none is in the legs.
    """
    model, timing, in_legs = infant.model, timing_of(infant.manifest, infant.senses), None
    if signal == MOTOR:
        bodies = model.jnt_bodyid[model.actuator_trnid[infant.actuation.actuators, 0]]
    if bodies is not None:
        in_legs = in_subtrees(model, [model.body(leg).id for leg in timing.legs])[bodies].repeat(count // len(bodies))
    steps = np.empty(count, np.intp)
    for _, late, part in timing.groups(signal, in_legs):
        steps[... if part is None else part] = late
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

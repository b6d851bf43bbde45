"""Signals of all infants on a device: delay lines and noise, and the senses that are read, disturbed and delayed.

A delay line follows the law of `mimoc.runtime.delays` over arrays. A signal is sent every e physics steps, and a delay
line is a ring of slots for as many of these times as the longest delay takes, and one more. The signal with the number
i is in the slot i modulo their number, so that a reset only fills all slots. Without jitter, e is the control step, and
a sense is sampled before the end of a control step by the rest of its delay, so that its samples arrive at the end of
one; with jitter, it is sampled after each physics step.

With control steps of 2 physics steps and a delay of 5, whose rest is 1, there are 3 slots:

    time       0   1   2   3   4   5   6   7   8
    sampled        a       b       c       d          into the slots 0, 1, 2, 0
    observed                               a       b

The history of a line is what was sent last, by age: the newest first, each number as far back as it is still on its way
or has just arrived. It is independent of times and slots, so that it can be put into lines with other delays.

Noise are the terms of the CPU (`mimoc.runtime.noise`), with other random numbers. Each is a function of the seed of its
world, of how often that has gone on to other numbers since, and of a place. So they depend neither on the other worlds
nor on the order in which kernels run.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import array_api_compat.torch as array_library
import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.spaces import Box, Dict

from mimoc.base.errors import MimocError
from mimoc.base.kinds import Code, function_of
from mimoc.base.units import ms_to_s, to_steps
from mimoc.runtime.delays import Mask, first_deviation, next_deviation, number_arriving, timing_of, within
from mimoc.runtime.device.arrays import put, term_of_worlds, where_worlds
from mimoc.runtime.device.states import Slot
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.gymnasium_forms import mixture_error
from mimoc.runtime.noise import Draw, Noise, bind_motor_noise, is_disturbed, processing_of
from mimoc.runtime.sense import CustomSense, IntArray, Sense
from mimoc.runtime.worlds import Worlds
from mimoc.schema.kinds import SENSES
from mimoc.schema.senses import MOTOR, noise_keys

Rows = torch.Tensor | slice
Uniforms = Callable[[Sequence[int]], torch.Tensor]  # Draws an array of a shape from [0, 1).


class Part(NamedTuple):
    """Numbers of a signal with a common delay, which depends on the infant."""

    columns: Rows
    delay: torch.Tensor  # Delay in physics steps, shape (worlds,).
    first: torch.Tensor  # When the signal with the number 0 is sent, shape (worlds,).
    slots: torch.Tensor  # How many slots are used, shape (worlds,).
    ring: torch.Tensor  # What is on its way, shape (slots, worlds, columns).
    rows_by_rest: dict[int, Rows]  # The worlds whose delay can take some physics steps more than whole control steps.
    channel: torch.Tensor  # Which of the deviations of each world is added to its delay, shape (worlds,).


class Delays(NamedTuple):
    """The delays of the n numbers of a signal, in physics steps; shape (n,), or (bodies, n)."""

    steps: IntArray
    jitter: IntArray  # How far the delay varies at most.
    channel: IntArray  # Which vary together: 1 for legs with a delay of their own, else 0.


class DelayLine:
    """The signals of all infants on their way from one sender.

    A control step of length p with the number c ends at the time c p, when samples arrive. A command is sent at c p,
    from which on its own control step is counted.
    """

    def __init__(
        self,
        delays: Delays,
        period: int,
        body: torch.Tensor,
        uniforms: Uniforms,
        are_commands: bool = False,
        dtype: torch.dtype = torch.float32,
    ):
        """Begin with nothing on its way.

        Args:
            delays: Of each body.
            period: Physics steps in a control step.
            body: The body in each world, shape (worlds,).
            uniforms: Draws the jitter.
            are_commands: Whether the signals are commands.
            dtype: Type of the numbers.
        """
        self._period = period
        self._worlds = torch.arange(len(body), device=body.device)
        self._uniforms = uniforms
        self._is_jittered = bool(delays.jitter.any())
        self._every = 1 if self._is_jittered and not are_commands else period
        self._last = period - 1 if are_commands else 0  # When something arrives last in a control step.
        self.rests: IntArray = np.arange(period) if self._is_jittered else np.unique(delays.steps % period)
        """Numbers of physics steps by which delays can be longer than whole control steps."""
        bodies, which = len(delays.steps), body.tolist()
        columns, self._parts = np.concatenate(delays), list[Part]()
        for column in np.unique(columns, axis=1).T:
            mask = (columns == column[:, None]).all(axis=0)
            delay, jitter, channel = column.reshape(3, bodies)[:, which]
            rest = np.zeros_like(delay) if self._is_jittered else delay % period
            slots = 1 - number_arriving(rest, delay + jitter, self._every)
            rows_by_rest: dict[int, Rows] = {int(rest): slice(None) for rest in self.rests}
            if not self._is_jittered:
                rows_by_rest = {int(other): _rows(rest == other) for other in np.unique(rest)}
            ring = torch.zeros((int(slots.max()), len(body), int(mask.sum())), dtype=dtype, device=body.device)
            arrays = (put(values) for values in (delay, 0 * rest if are_commands else -rest, slots))
            self._parts.append(Part(_rows(mask), *arrays, ring, rows_by_rest, put(channel)))
        self.arrived = torch.zeros((len(body), columns.shape[1]), dtype=dtype, device=body.device)
        most = np.zeros((bodies, int(delays.channel.max(initial=0)) + 1), np.intp)
        np.maximum.at(most, (np.arange(bodies)[:, None], delays.channel), delays.jitter)
        self._most = put(most if self._is_jittered else most[:, :0])[body]
        self.deviations = torch.zeros_like(self._most)  # Deviations of delays now, shape (worlds, channels).

    def send(self, clock: torch.Tensor, values: torch.Tensor, rest: int | None = None) -> None:
        """Send values, shape (worlds, n), or samples *rest* physics steps before the end of a control step.

        Without jitter, only the numbers whose delay has this rest are sent.
        """
        time = clock * self._period - (rest or 0)
        for part, rows in self._due(rest):
            slots = (number_arriving(time, part.first, self._every) % part.slots)[rows]
            part.ring[slots, self._worlds[rows]] = values[:, part.columns][rows]

    def receive(self, clock: torch.Tensor, rest: int | None = None) -> torch.Tensor:
        """Return what has arrived, shape (worlds, n), at the end of a control step, or of commands after *rest*.

        Without jitter, only the numbers whose delay has this rest are renewed.
        """
        time = clock * self._period + (rest or 0)
        for part, rows in self._due(rest):
            slots = (number_arriving(time, self._late(part), self._every) % part.slots)[rows]
            places = rows if isinstance(rows, slice) or isinstance(part.columns, slice) else rows[:, None]
            self.arrived[places, part.columns] = part.ring[slots, self._worlds[rows]]
        return self.arrived

    def advance(self, physics_steps: int) -> None:
        """Let delays vary over some physics steps."""
        if self._is_jittered:
            for drawn in self._uniforms((*self.deviations.shape, physics_steps)).unbind(dim=-1):
                self.deviations = next_deviation(self.deviations, self._most, drawn, torch.Tensor.long)

    def deviate(self, deviations: torch.Tensor) -> None:
        """Set the deviations of delays, shape (worlds, channels), limited to the jitter."""
        self.deviations = torch.minimum(torch.maximum(deviations, -self._most), self._most)

    def fill(self, begin: torch.Tensor, start: torch.Tensor) -> None:
        """Fill the lines of worlds that begin, shape (worlds,), with rows of *start*."""
        for part in self._parts:
            torch.where(begin[:, None], start[:, part.columns], part.ring, out=part.ring)
        if self._is_jittered:
            drawn = first_deviation(self._most, self._uniforms(self.deviations.shape), torch.Tensor.long)
            self.deviations = where_worlds(begin, drawn, self.deviations)

    def history(self, clock: torch.Tensor) -> torch.Tensor:
        """Return what was sent, the newest first, shape (worlds, ages, n); the oldest is repeated."""
        ages = torch.arange(max(len(part.ring) for part in self._parts), device=clock.device)[:, None]
        sent = self.arrived.new_empty((len(ages), *self.arrived.shape))
        for part in self._parts:
            newest = self._newest(part, clock)
            arrived = number_arriving(clock * self._period + self._last, self._late(part), self._every)
            slots = torch.maximum(newest - ages, arrived) % part.slots
            sent[:, :, part.columns] = part.ring[slots, self._worlds]
        return sent.movedim(0, 1)

    def restore(self, clock: torch.Tensor, history: torch.Tensor) -> None:
        """Put a history on its way, shape (worlds, ages, n); where it is too short, its oldest signal is repeated."""
        for part in self._parts:
            slots = torch.arange(len(part.ring), device=clock.device)[:, None]
            ages = ((self._newest(part, clock) - slots) % part.slots).clamp(max=history.shape[1] - 1)
            part.ring.copy_(history[self._worlds, ages][:, :, part.columns])

    def slot(self, clock: torch.Tensor) -> Slot:
        """Return the history of the line at a time, as a part of states."""
        return Slot(lambda: self.history(clock), lambda history: self.restore(clock, history))

    def _late(self, part: Part) -> torch.Tensor:
        """Return the time from which the numbers of arriving signals are counted."""
        late = part.delay + part.first
        return late + self.deviations[self._worlds, part.channel] if self._is_jittered else late

    def _newest(self, part: Part, clock: torch.Tensor) -> torch.Tensor:
        return number_arriving(clock * self._period + self._last, part.first, self._every)

    def _due(self, rest: int | None) -> Iterator[tuple[Part, Rows]]:
        for part in self._parts:
            if rest is None:
                yield part, slice(None)
            elif rest in part.rows_by_rest:
                yield part, part.rows_by_rest[rest]


def _rows(mask: Mask) -> Rows:
    return slice(None) if mask.all() else put(np.flatnonzero(mask))


PLACES = 1 << 23  # How many random numbers a channel has at a time.
CHANNELS = 128  # How many channels of noise there are at most; the places of others are behind theirs.
SEEDS = 2**31  # How many different seeds worlds can have.


class CounterRandom:
    """The random numbers of all worlds."""

    def __init__(self, seeds: torch.Tensor):
        self.seeds = seeds.int()
        self.steps = torch.zeros_like(self.seeds)  # Draws of each world since it was seeded.

    def restart(self, seeds: Mapping[int, int]) -> None:
        """Restart the worlds that get a new seed."""
        worlds = list(seeds)
        self.steps[worlds] = 0
        self.seeds[worlds] = self.seeds.new_tensor([seed % SEEDS for seed in seeds.values()])

    def normals(self, first: int, shape: Sequence[int]) -> torch.Tensor:
        """Return standard normal numbers of shape (worlds, ...), from a place on."""
        return self._drawn(_draw, first, shape)

    def uniforms_of(self, number: int) -> Uniforms:
        """Return a function that draws from [0, 1) for the signal with a number."""
        return lambda shape: self._drawn(_draw_uniforms, (CHANNELS + number) * PLACES, shape)

    def _drawn(self, kernel: wp.Kernel, first: int, shape: Sequence[int]) -> torch.Tensor:
        numbers = torch.empty((shape[0], math.prod(shape[1:])), device=self.seeds.device)
        inputs = [wp.from_torch(self.seeds), wp.from_torch(self.steps), first]
        wp.launch(kernel, tuple(numbers.shape), inputs, [wp.from_torch(numbers)])
        return numbers.reshape(tuple(shape))


class DeviceNoise:
    """The noise of one signal of all worlds, with its state."""

    def __init__(self, signal: str, noises: Sequence[Noise], body: torch.Tensor, chance: CounterRandom):
        self._noise = term_of_worlds(f"noise of {signal}", noises, body)
        self._chance = chance
        draws = [*noise_keys(), MOTOR]
        self._first = draws.index(signal) * 2 * PLACES if signal in draws else 0  # Others only have filters.
        self.state: torch.Tensor | None = None  # Shape (worlds, ...), if the noise has one.

    def __call__(self, signal: torch.Tensor, elapsed_s: float) -> torch.Tensor:
        """Return a signal with noise, shape (worlds, n), some time after the last one."""
        noisy, self.state = self._noise(self._draw(self._first, elapsed_s), signal, self.state)
        return noisy

    def begin(self, signal: torch.Tensor, begins: torch.Tensor) -> torch.Tensor:
        """Return the signal with new noise; worlds that do not begin, shape (worlds,), keep the state of theirs."""
        noisy, state = self._noise(self._draw(self._first + PLACES, math.inf), signal, None)
        is_kept = state is not None and self.state is not None
        self.state = where_worlds(begins, state, self.state) if is_kept else state
        return noisy

    def _draw(self, first: int, elapsed_s: float) -> Draw:
        return Draw(array_library, elapsed_s, lambda shape, where=None: self._chance.normals(first, shape))


def noise_of(
    signal: str, infants: Sequence[InfantEnv], body: torch.Tensor, chance: CounterRandom
) -> DeviceNoise | None:
    """Return the noise of a sense, or of the commands, or None if no infant has any."""

    def noise(infant: InfantEnv, force: bool) -> Noise | None:
        entry, actuation = infant.manifest.noise, infant.actuation
        if signal == MOTOR:
            return bind_motor_noise(entry, actuation) if force or is_disturbed(entry, actuation) else None
        return processing_of(signal, infant.senses[signal], entry, force)

    if not any(noise(infant, force=False) for infant in infants):
        return None
    noises = [bound for infant in infants if (bound := noise(infant, force=True))]
    if len(noises) < len(infants):
        raise mixture_error("some", f"whether sense '{signal}' has a filter")
    return DeviceNoise(signal, noises, body, chance)


@wp.func
def _generator(world_seed: int, step: int, place: int) -> wp.uint32:
    """Return the generator of a place; where those of two worlds coincide, they differ in the next step."""
    return wp.rand_init(wp.int32(wp.rand_init(world_seed, step)), wp.int32(wp.rand_init(place, step)))


@wp.kernel(enable_backward=False)
def _draw(seeds: wp.array[int], steps: wp.array[int], first: int, numbers: wp.array2d[float]):
    world, number = wp.tid()
    numbers[world, number] = wp.randn(_generator(seeds[world], steps[world], first + number))


@wp.kernel(enable_backward=False)
def _draw_uniforms(seeds: wp.array[int], steps: wp.array[int], first: int, numbers: wp.array2d[float]):
    world, number = wp.tid()
    numbers[world, number] = wp.randf(_generator(seeds[world], steps[world], first + number))


@dataclass(frozen=True)
class DeviceSetup:
    """What the device part of a sense is bound to."""

    infants: Sequence[InfantEnv]
    body: torch.Tensor  # The body in each world, shape (worlds,).
    model: mjw.Model
    touch: str  # `bodies` or `points`: the option of the environment.


class DeviceReader(Protocol):
    """Reads a sense of all infants.

    If it observes something else than the CPU does, it also has `spaces`, `bodies`, and `start(sample)`, which converts
    a sample of the CPU, shape (n,).
    """

    def __call__(self, data: mjw.Data) -> torch.Tensor:
        """Return the present sample, shape (worlds, n), in memory that the next call may write to."""
        ...


class DeviceSense:
    """A sense of all infants."""

    def __init__(self, name: str, setup: DeviceSetup, chance: CounterRandom):
        infants = setup.infants
        body = setup.body
        manifest = setup.infants[0].manifest
        device = device_part(name, infants[0].senses[name])
        self.reader: DeviceReader | None = function_of(device, "bind")(setup) if device else None
        terms: list[Any] = [infant.senses[name].term for infant in infants]
        self._term: Any = None if device else term_of_worlds(f"sense '{name}'", terms, body)
        self.noise = noise_of(name, infants, body, chance)
        self._timestep_s = ms_to_s(manifest.timestep_ms)
        self._period = round(manifest.step_ms / manifest.timestep_ms)
        self.spaces: list[Mapping[str, Box]] = [
            getattr(self.reader, "spaces", infant.senses[name].spaces) for infant in infants
        ]  # Spaces of each body.
        boxes = list(self.spaces[0].values())
        self._sizes = [int(np.prod(box.shape)) for box in boxes]
        self._is_picture = boxes[0].dtype == np.uint8 and device is not None
        bodies = [getattr(self.reader, "bodies", infant.senses[name].bodies) for infant in infants]
        self.line = line_of(name, setup, sum(self._sizes), chance, bodies, self._is_picture)
        bounds = [np.stack([_bound(spaces, which) for spaces in self.spaces]) for which in ("low", "high")]
        self._bounds = [put(rows[:1]) if (rows == rows[:1]).all() else put(rows)[body] for rows in bounds]

    def sample(self, worlds: Worlds, clock: torch.Tensor, rest: int) -> None:
        """Sample what is due *rest* physics steps before the end of the control step."""
        if rest not in self.line.rests:
            return
        sample = self.reader(worlds.datas[0]) if self.reader else self._term(worlds).flatten(1)
        if self.noise:
            earlier = min((other - rest) % self._period or self._period for other in self.line.rests)
            sample = self.noise(sample, float(earlier) * self._timestep_s)
        self.line.send(clock, sample, rest)

    def arrive(self, clock: torch.Tensor, observation: Mapping[str, torch.Tensor]) -> None:
        """Write what has arrived, within its bounds, to the observation."""
        arrived = self.line.receive(clock)
        if not self._is_picture:
            torch.clamp(arrived.nan_to_num_(0.0, math.inf, -math.inf), *self._bounds, out=arrived)
        for name, values in zip(self.spaces[0], arrived.split(self._sizes, dim=1), strict=True):
            observation[name].copy_(values.view(observation[name].shape))

    def refill(self, sample: torch.Tensor, begin: torch.Tensor) -> None:
        """Fill the delay lines of worlds that begin, shape (worlds,), with samples and new noise."""
        self.line.fill(begin, self.noise.begin(sample, begin) if self.noise else sample)


def device_part(name: str, sense: Sense) -> Code | None:
    """Return the device part of a sense, which reads it in place of a term; None if it has none."""
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
    kind = torch.uint8 if is_picture else torch.float32
    period = to_steps(manifest.step_ms, manifest.timestep_ms)
    uniforms = chance.uniforms_of([*infants[0].senses, MOTOR].index(signal))
    return DelayLine(together, period, setup.body, uniforms, signal == MOTOR, kind)


def delays_of(infant: InfantEnv, signal: str, count: int, bodies: IntArray | None = None) -> Delays:
    """Return the delay of each of *count* numbers of an infant's signal; equally many belong to each of *bodies*."""
    model = infant.model
    timing = timing_of(infant.manifest, infant.senses)
    if signal == MOTOR:
        bodies = model.jnt_bodyid[model.actuator_trnid[infant.actuation.actuators, 0]]
    where = None if bodies is None else within(model, bodies.repeat(count // len(bodies)))
    delays = Delays(*np.zeros((len(Delays._fields), count), np.intp))
    for channel, (_, late, part) in enumerate(timing.groups(signal, where)):
        for values, value in zip(delays, (late, timing.jitter(late), channel), strict=True):
            values[... if part is None else part] = value
    return delays


def space_of(infant: InfantEnv, senses: Mapping[str, DeviceSense], body: int) -> Dict:
    """Return the observation space of an infant on the device; touch by bodies differs from the CPU."""
    spaces: Mapping[str, Any] = infant.observation_space.spaces
    return Dict({**spaces, **{name: box for sense in senses.values() for name, box in sense.spaces[body].items()}})


def _bound(spaces: Mapping[str, Box], which: str) -> Any:
    return np.concatenate([getattr(box, which).ravel().astype(np.float64) for box in spaces.values()])


class DeviceError(MimocError):
    """Infants that cannot be simulated on a device, or whose simulation failed there."""


def find_device(name: str) -> Any:
    """Return one of Warp's devices."""
    try:
        return wp.get_device(name)
    except (ValueError, RuntimeError):
        devices = ", ".join(device.alias for device in wp.get_devices())
        none = "" if wp.is_cuda_available() else " and no NVIDIA GPU with its driver"
        raise DeviceError(f"device '{name}' is not there; MuJoCo Warp finds {devices}{none} on this machine") from None


def check_infant(infant: InfantEnv) -> None:
    """Raise a DeviceError if an infant has anything that cannot run on a device."""
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

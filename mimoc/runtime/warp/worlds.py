"""The worlds of all infants on a device: one control step of all of them, without a word to the CPU."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import mujoco_warp as mjw
import numpy as np
import warp as wp
from gymnasium.vector import AutoresetMode

from mimoc.delays.spec import MOTOR
from mimoc.noise.motor import bind_motor_noise
from mimoc.noise.noise import bind_noise, noise_amount
from mimoc.noise.spec import noise_keys
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp import ending
from mimoc.runtime.warp.arrays import put
from mimoc.runtime.warp.bodies import batched_data, batched_model, enlarged
from mimoc.runtime.warp.capacity import LARGEST, SPARE_CONSTRAINTS, SPARE_CONTACTS, Capacity, measured
from mimoc.runtime.warp.device_worlds import device_worlds, term_of_worlds
from mimoc.runtime.warp.lines import Line
from mimoc.runtime.warp.needs import DeviceError
from mimoc.runtime.warp.noise import Chance, DeviceNoise, NoisyCommands
from mimoc.runtime.warp.overflow import COUNTS, FLAGS, NOT_FINITE, OVERFLOWED
from mimoc.runtime.warp.room import RARE, Room
from mimoc.runtime.warp.signals import Channel, Numbers, delays_of, space_of
from mimoc.runtime.warp.starts import Starts, drawn, model_fields, seen_at
from mimoc.runtime.warp.tasks import device_task
from mimoc.runtime.warp.tasks.task import Judged
from mimoc.runtime.warp.touch import Feeling
from mimoc.runtime.warp.vectors import TermReader
from mimoc.runtime.warp.vision.sight import VISION, Sight
from mimoc.senses.sense import IntArray
from mimoc.units import ms_to_s, to_steps

GOAL = "goal"
NO_MEMORY = "Failed to allocate"
"""What Warp says when the memory of a device does not do."""


class Worlds:
    """Everything on the device, and what happens there; all arrays keep their place in memory until the room grows."""

    def __init__(
        self,
        infants: Sequence[InfantEnv],
        body_of_world: IntArray,
        room: tuple[int | None, int | None],
        touch: str,
        starts: int,
        mode: AutoresetMode,
        max_steps: int | None,
    ):
        """Set everything up on Warp's present device; see `WarpInfants`."""
        self._infants, self._mode, self._most_starts = infants, mode, starts
        manifest, count = infants[0].manifest, len(body_of_world)
        self.period = to_steps(manifest.step_ms, manifest.timestep_ms)
        fields = {field.name for infant in infants for field in model_fields(infant)}
        self.model = batched_model([each.model for each in infants], body_of_world, fields)
        self.room = self._first_room(room, count)
        self.overflows = dict.fromkeys(FLAGS, 0)
        """How often each of MuJoCo Warp's flags was set: control steps of all infants together."""
        present, models = self.room.present, [each.model for each in infants]
        self.data = batched_data(models, body_of_world, present.contacts, present.constraints)
        self.body = put(body_of_world, wp.int32)
        self.task, self.clock = device_task(infants, count), wp.zeros(1, dtype=int)
        self.chance = Chance(put(np.arange(count), wp.int32))
        self._open_signals(touch)
        self.ended = ending.Ending(infants, self.body, len(self.task.terms), max_steps, self.chance.seeds)
        self.default_starts = self.starts(None)
        self.memory = wp.zeros((count, self.default_starts.memory.shape[1]), dtype=float)
        self._judged = Judged(
            self.body,
            self.actions,
            self.memory,
            self.ended.terms,
            self.ended.success,
            self.ended.terminated,
        )

    def _open_signals(self, touch: str) -> None:
        """Find what is sensed and commanded, with its delays and noise."""
        self._is_noisy = False
        first, count = self._infants[0], self.body.shape[0]
        self._touch = Feeling(touch, self._infants, self.body) if "touch" in first.senses else None
        self.spaces = [space_of(infant, self._touch) for infant in self._infants]
        self.channels: dict[str, Channel] = {
            name: self._channel(name) for name in first.senses if name not in (VISION, "nothing")
        }
        self.sight = self._sight() if VISION in first.senses else None
        if self.sight:
            self.channels[VISION] = self.sight
        self._columns = put(first.actuation.actuators, wp.int32)
        self._own_columns = put(np.arange(len(first.actuation.actuators)), wp.int32)
        delays = np.stack([delays_of(infant, MOTOR) for infant in self._infants])
        self.commands = Line(delays, self.period, self.body)
        self.actions = wp.zeros_like(self.commands.entering)
        """Of the present control step, shape (worlds, n)."""
        self._controls_of = first.actuation.command and term_of_worlds(
            [infant.actuation.command for infant in self._infants], self.body.numpy()
        )
        self._motor_noise = self._noisy_commands()
        spaces: dict[str, Any] = dict(self.spaces[0].items())
        self.observation = {
            name: wp.zeros((count, *space.shape), dtype=wp.uint8 if space.dtype == np.uint8 else float)
            for name, space in spaces.items()
        }
        self.final = {name: wp.zeros_like(array) for name, array in self.observation.items()}

    def _channel(self, name: str) -> Numbers:
        """Return a sense of numbers."""
        read = self._touch if name == "touch" else TermReader(name, self._infants, self.body)
        noise, entries = None, [infant.manifest.noise for infant in self._infants]
        if any(noise_amount(name, entry) for entry in entries):
            noises = [
                bind_noise(name, each.senses[name], entry) for each, entry in zip(self._infants, entries, strict=True)
            ]
            noise = DeviceNoise(noises, self.body.numpy(), self.chance, list(noise_keys()).index(name))
        self._is_noisy |= noise is not None
        return Numbers(name, self._infants, self.spaces, self.body, read, noise)

    def _noisy_commands(self) -> NoisyCommands | None:
        """Return the commands with their noise, or None if no infant has any."""
        if not any(infant.manifest.noise.motor for infant in self._infants):
            return None
        noises = [bind_motor_noise(infant.manifest.noise, infant.actuation) for infant in self._infants]
        noise = DeviceNoise(noises, self.body.numpy(), self.chance, len(noise_keys()))
        self._is_noisy, first = True, self._infants[0]
        timestep_s = ms_to_s(first.manifest.timestep_ms)
        return NoisyCommands(noise, first.actuation.actuators, self.body.shape[0], timestep_s)

    def _sight(self) -> Sight:
        """Return the eyes of all infants."""
        manifests, models = zip(*((each.manifest, each.model) for each in self._infants), strict=True)
        return Sight(manifests, models, self.body.numpy(), self.body, self.model, self.period)

    def starts(self, pose: str | None) -> Starts:
        """Return the starts of all bodies in a pose."""
        found = drawn(self._infants, self._most_starts, pose, self.model, self.task, self._touch)
        if self.sight is None:
            return found
        seen = seen_at(found, self.sight, self.body.numpy(), self.model, self.data)
        return replace(found, samples={**found.samples, VISION: seen})

    def seed(self, seeds: Mapping[int, int]) -> None:
        """Give new seeds to some worlds."""
        self.chance.restart(seeds)
        self.ended.forget(seeds)

    def begin(self, starts: Starts, chosen: wp.array) -> None:
        """Start an episode in the worlds that a start is chosen for; -1 is none."""
        starts.restore(chosen, self.model, self.data, self.memory)
        self.commands.refill(chosen, starts.commands)
        if self._motor_noise:
            rows, begins = wp.to_torch(chosen).clamp(min=0).long(), wp.to_torch(chosen) >= 0
            self._motor_noise.begin(wp.to_torch(starts.commands)[rows], begins)
        for channel in self.channels.values():
            channel.refill(chosen, starts.samples)
        self.ended.begin(chosen)

    def step(self) -> None:
        """Make a control step of all worlds with `actions`, and begin new episodes as the mode says."""
        wp.launch(_tick, 1, [], [self.clock])
        self._take_actions()
        self.commands.send(self.clock, -1)
        for index in range(self.period):
            self._command(index)
            mjw.step(self.model, self.data)
            for channel in self.channels.values():
                channel.sample(self.model, self.data, self.clock, self.period - 1 - index)
        self.ended.clear()
        self.task.judge(self.model, self.data, self._judged)
        self.ended.judge(self.data, self.actions, self._mode, self.default_starts)
        if self._mode == AutoresetMode.SAME_STEP:
            self.observe()
            for name, array in self.observation.items():
                wp.copy(self.final[name], array)
        if self._mode != AutoresetMode.DISABLED:
            self.begin(self.default_starts, self.ended.chosen)
        self.observe()

    def settle(self) -> bool:
        """Count what did not fit in the last step, make more room where it was short, and return whether it grew.

        Raises:
            DeviceError: If commands were not finite, or the room is as large as it gets and many infants lost contacts.
        """
        report = self.ended.report.numpy()
        for name, bit in FLAGS.items():
            self.overflows[name] += int(report[COUNTS + bit])
        if report[NOT_FINITE]:
            raise DeviceError(f"the last actions of infant {report[NOT_FINITE] - 1} were not finite")
        if self._make_room(self.room.after(report)):
            return True
        if report[OVERFLOWED] > RARE * self.room.worlds:
            raise DeviceError(self._lack(int(report[OVERFLOWED])))
        return False

    def _make_room(self, wanted: Capacity) -> bool:
        """Grow, and return whether there is more room; what the device has no memory for is more than it gets."""
        if wanted == self.room.present:
            return False
        try:
            self.data = enlarged(self.data, self._infants[0].model, wanted.contacts, wanted.constraints)
        except RuntimeError as error:
            if NO_MEMORY not in str(error):
                raise
            self.room.largest = self.room.present
            return False
        self.room.present = wanted
        return True

    def _lack(self, count: int) -> str:
        """Return what is wrong if many infants lose contacts and the room cannot grow."""
        first, limit = int(np.flatnonzero(self.ended.overflowed.numpy())[0]), self.room.present
        return (
            f"contacts or constraints of {count} infants, such as {first}, did not fit in the last step, and there is "
            f"no more room than contacts={limit.contacts} and constraints={limit.constraints}: look at what holds "
            "these infants, or make the environment with more, or with fewer infants"
        )

    def observe(self) -> None:
        """Write what has arrived of all senses, and what the task adds."""
        for channel in self.channels.values():
            channel.arrive(self.clock, self.observation)
        if self.task.goal:
            self.task.observe(self.memory, self.observation[GOAL])

    def _take_actions(self) -> None:
        """Let the controls that the actions mean be sent."""
        if self._controls_of is None:
            wp.copy(self.commands.entering, self.actions)
        else:
            controls = self._controls_of(device_worlds(self.data), wp.to_torch(self.actions))
            wp.to_torch(self.commands.entering).copy_(controls)

    def _command(self, index: int) -> None:
        """Set the controls of a physics step."""
        if self._is_noisy:
            self.chance.advance()
        if self._motor_noise:
            self.commands.apply(self.clock, index, self._own_columns, wp.from_torch(self._motor_noise.commanded))
            self._motor_noise(wp.to_torch(self.data.ctrl))
        else:
            self.commands.apply(self.clock, index, self._columns, self.data.ctrl)

    def _first_room(self, given: tuple[int | None, int | None], worlds: int) -> Room:
        """Return the room for contacts and constraints, measured where nothing was said."""
        poses, pairs = [each.manifest.pose for each in self._infants], self.model.nxn_geom_pair_filtered.numpy()
        needed = measured([each.model for each in self._infants], poses, pairs)
        usual, largest = needed.times(SPARE_CONTACTS, SPARE_CONSTRAINTS), needed.times(LARGEST, LARGEST)
        present = Capacity(given[0] or usual.contacts, given[1] or usual.constraints)
        return Room(present, largest, worlds)


@wp.kernel(enable_backward=False)
def _tick(clock: wp.array[int]):
    clock[0] = clock[0] + 1

"""The worlds of all infants on a device: one control step of all of them, without a word to the CPU."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.vector import AutoresetMode

from mimoc.base.units import to_steps
from mimoc.delays.spec import MOTOR
from mimoc.runtime.device.arrays import device_worlds, put_on, term_of_worlds, to_device
from mimoc.runtime.device.bodies import batched_data, batched_model, enlarged
from mimoc.runtime.device.capacity import COUNTS, FLAGS, NOT_FINITE, OVERFLOWED, RARE, Capacity, Room, lack
from mimoc.runtime.device.episode_ends import DeviceTask, EpisodeEnds
from mimoc.runtime.device.initial_states import InitialStates, changed_rows, sample_initial_states, seen_at
from mimoc.runtime.device.noise import CounterRandom, motor_noise
from mimoc.runtime.device.signals import DeviceError, DeviceSense, DeviceSetup, Line, delays_of, space_of
from mimoc.runtime.device.vision.reader import VISION
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import IntArray

NO_MEMORY = "Failed to allocate"
"""What Warp says when the memory of a device does not do."""


class DeviceSimulation:
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
        """Set everything up on Warp's present device; see `DeviceEnv`."""
        self._infants, self._mode, self._most_starts, self._device = infants, mode, starts, wp.get_device()
        manifest, count = infants[0].manifest, len(body_of_world)
        self.period = to_steps(manifest.step_ms, manifest.timestep_ms)
        fields = {name for infant in infants for name in changed_rows(infant)}
        self.model = batched_model([infant.model for infant in infants], body_of_world, fields)
        self.room = Room.at_first(infants, self.model.nxn_geom_pair_filtered.numpy(), room, count)
        self.overflows = dict.fromkeys(FLAGS, 0)
        """How often each of MuJoCo Warp's flags was set: control steps of all infants together."""
        self.captures, self._graphs = self._device.is_cuda, dict[int, wp.Graph]()
        """Whether physics steps are captured as graphs, and those of some numbers of steps."""
        present, models = self.room.present, [infant.model for infant in infants]
        self.data = batched_data(models, body_of_world, present.contacts, present.constraints)
        self.body = to_device(body_of_world, wp.int32)
        self.task, self._seen_by_terms = DeviceTask(infants, body_of_world), device_worlds(self.data)
        self.clock = torch.zeros((), dtype=torch.int64, device=wp.device_to_torch(self._device))
        """Control steps so far."""
        self.chance = CounterRandom(to_device(np.arange(count), wp.int32))
        self._open_signals(touch)
        self.ended = EpisodeEnds(infants, self.body, self.task.terms, max_steps, self.chance.seeds)
        self.default_starts = self.starts(None)

    def _open_signals(self, touch: str) -> None:
        """Find what is sensed and commanded, with its delays and noise."""
        first, count = self._infants[0], self.body.shape[0]
        setup = DeviceSetup(self._infants, self.body, self.model, touch)
        self.senses = {name: DeviceSense(name, setup, self.chance) for name in first.senses}
        self.spaces = [space_of(infant, self.senses, body) for body, infant in enumerate(self._infants)]
        actuators = first.actuation.actuators
        delays = np.stack([delays_of(infant, MOTOR, len(actuators)) for infant in self._infants])
        self.commands = Line(delays, self.period, self.body)
        self.actions = wp.zeros((count, len(actuators)), dtype=float)
        """Of the present control step, shape (worlds, n)."""
        commands: list[Any] = [infant.actuation.command for infant in self._infants]
        self._controls_of = commands[0] and term_of_worlds("commands", commands, self.body)
        self._motor_noise = motor_noise(self._infants, self.body, self.chance)
        columns = np.arange(len(actuators)) if self._motor_noise else actuators
        self._columns, self._worlds = map(put_on(self._device), (columns, np.arange(count)))
        sampled = {int(self.period - rest) for sense in self.senses.values() for rest in sense.line.rests}
        applied = {int(rest) for rest in self.commands.rests}
        noisy = range(self.period) if self._motor_noise else ()
        self._segments = tuple(pairwise(sorted({0, self.period, *sampled, *applied, *noisy})))
        spaces: dict[str, Any] = dict(self.spaces[0].items())
        self.observation = {
            name: wp.zeros((count, *space.shape), dtype=wp.uint8 if space.dtype == np.uint8 else float)
            for name, space in spaces.items()
        }
        self.final = {name: wp.zeros_like(array) for name, array in self.observation.items()}

    def starts(self, pose: str | None) -> InitialStates:
        """Return the starts of all bodies in a pose."""
        touch: Any = self.senses["touch"].read if "touch" in self.senses else None
        starts = sample_initial_states(self._infants, self._most_starts, pose, self.model, touch)
        if VISION not in self.senses:
            return starts
        sight: Any = self.senses[VISION].read
        seen = seen_at(starts, sight, self.body.numpy(), self.model, self.data)
        return replace(starts, samples={**starts.samples, VISION: seen})

    def seed(self, seeds: Mapping[int, int]) -> None:
        """Give new seeds to some worlds."""
        self.chance.restart(seeds)
        self.ended.forget(seeds)

    def begin(self, starts: InitialStates, chosen: wp.array) -> None:
        """Start an episode in the worlds that a start is chosen for; -1 is none."""
        starts.restore(chosen, self.model, self.data, self.task.memory)
        start, begin = wp.to_torch(chosen).clamp(min=0).long(), wp.to_torch(chosen) >= 0
        self.commands.fill(begin, wp.to_torch(starts.commands)[start])
        if self._motor_noise:
            self._motor_noise.begin(wp.to_torch(starts.commands)[start], begin)
        for sense in self.senses.values():
            sense.refill(chosen, starts.samples)
        self.ended.begin(chosen)

    def step(self) -> None:
        """Make a control step of all worlds with `actions`, and begin new episodes as the mode says.

        It is cut wherever commands arrive, noise is drawn or a sense is sampled. On a GPU, the physics steps between
        two cuts are one graph; terms run between these graphs.
        """
        self.clock += 1
        actions = wp.to_torch(self.actions)
        controls = self._controls_of(self._seen_by_terms, actions) if self._controls_of else actions
        self.commands.send(self.clock, controls)
        for start, end in self._segments:
            self._command(start)
            self._physics(end - start)
            for sense in self.senses.values():
                sense.sample(self.data, self.clock, self.period - end)
        judgement = self.task.judge(self._seen_by_terms, self.model, actions)
        self.ended.judge(judgement, self.data, self.actions, self._mode, self.default_starts)
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
            raise DeviceError(lack(self.ended.overflowed.numpy(), self.room.present))
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
        self.room.present, self._seen_by_terms = wanted, device_worlds(self.data)
        self._graphs = {}  # They have the places of the former arrays in memory.
        return True

    def observe(self) -> None:
        """Write what has arrived of all senses, and what the task adds."""
        for sense in self.senses.values():
            sense.arrive(self.clock, self.observation)
        for name in self.task.observed:
            wp.to_torch(self.observation[name]).copy_(self.task.memory[name])

    def _command(self, index: int) -> None:
        """Set the controls of the physics steps that follow."""
        if self.chance.is_used:
            self.chance.advance()
        controls = self._motor_noise.commanded if self._motor_noise else wp.to_torch(self.data.ctrl)
        for rows, numbers, values in self.commands.arrive(self.clock, index):
            controls[self._worlds[rows, None], self._columns[numbers]] = values
        if self._motor_noise:
            self._motor_noise(wp.to_torch(self.data.ctrl))

    def _physics(self, steps: int) -> None:
        """Make physics steps: on a GPU as one graph, which is captured after the first ones have loaded all kernels."""
        if self.captures and steps in self._graphs:
            wp.capture_launch(self._graphs[steps])
            return
        self._physics_steps(steps)
        if self.captures:
            with wp.ScopedCapture(self._device) as capture:
                self._physics_steps(steps)
            self._graphs[steps] = capture.graph

    def _physics_steps(self, count: int) -> None:
        for _ in range(count):
            mjw.step(self.model, self.data)

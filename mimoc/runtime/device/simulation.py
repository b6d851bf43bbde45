"""The worlds of all infants on a device: one control step of all of them, without a word to the CPU."""

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.vector import AutoresetMode

from mimoc.actuation.arousal import Arousal
from mimoc.base.units import ms_to_s, to_steps
from mimoc.delays.spec import MOTOR
from mimoc.runtime.device.arousal import DeviceArousal
from mimoc.runtime.device.arrays import device_worlds, put, term_of_worlds, where_worlds
from mimoc.runtime.device.bodies import batched_data, batched_model, enlarged
from mimoc.runtime.device.capacity import COUNTS, FLAGS, NOT_FINITE, OVERFLOWED, RARE, Capacity, Room
from mimoc.runtime.device.episode_ends import DeviceTask, EpisodeEnds
from mimoc.runtime.device.initial_states import InitialStates, changed_rows, sample_initial_states
from mimoc.runtime.device.noise import CounterRandom, noise_of
from mimoc.runtime.device.signals import DeviceError, DeviceSense, DeviceSetup, Line, delays_of, space_of
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import IntArray

NO_MEMORY = "Failed to allocate"
"""What Warp says when the memory of a device does not do."""


class DeviceSimulation:
    """Everything on the device, and what happens there."""

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
        manifest, models, count = infants[0].manifest, [infant.model for infant in infants], len(body_of_world)
        self.period, self._timestep_s = to_steps(manifest.step_ms, manifest.timestep_ms), ms_to_s(manifest.timestep_ms)
        arousals = [Arousal(infant.manifest.actuation, infant.model) for infant in infants]
        changed = {name for infant in infants for name in changed_rows(infant)}
        changed |= {name for arousal in arousals for name in arousal.fields}
        self.model = batched_model(models, body_of_world, changed)
        self.room = Room.at_first(infants, self.model.nxn_geom_pair_filtered.numpy(), room, count)
        self.overflows = dict.fromkeys(FLAGS, 0)
        """How often each of MuJoCo Warp's flags was set: control steps of all infants together."""
        self.captures, self._graphs = self._device.is_cuda, dict[int, wp.Graph]()
        """Whether physics steps are captured as graphs, and those of some numbers of steps."""
        present = self.room.present
        self.data = batched_data(models, body_of_world, present.contacts, present.constraints)
        self._worlds = device_worlds(self.data)
        self.body, self.clock = put(body_of_world), put(0)
        """Which body lives in each world, and control steps so far."""
        self.arousal = DeviceArousal(arousals, self.body, models[0].jnt_qposadr, self.model)
        self.task, self.chance = DeviceTask(infants, self.body), CounterRandom(put(np.arange(count)))
        self._open_signals(touch)
        self.ended = EpisodeEnds(infants, self.body, max_steps, mode)
        self.default_starts = self.starts(None)

    def _open_signals(self, touch: str) -> None:
        """Find what is sensed and commanded, with its delays and noise."""
        first, count = self._infants[0], len(self.body)
        setup = DeviceSetup(self._infants, self.body, self.model, touch)
        self.senses = {name: DeviceSense(name, setup, self.chance) for name in first.senses}
        self.spaces = [space_of(infant, self.senses, body) for body, infant in enumerate(self._infants)]
        self._actuators = put(first.actuation.actuators)
        delays = [delays_of(infant, MOTOR, len(self._actuators)) for infant in self._infants]
        self.commands = Line(np.stack(delays), self.period, self.body)
        self.actions = torch.zeros_like(self.commands.arrived)
        """Of the present control step, shape (worlds, n)."""
        commands: list[Any] = [infant.actuation.command for infant in self._infants]
        self._controls_of = commands[0] and term_of_worlds("commands", commands, self.body)
        self._motor_noise = noise_of(MOTOR, self._infants, self.body, self.chance)
        sampled = {int(self.period - rest) for sense in self.senses.values() for rest in sense.line.rests}
        applied = {int(rest) for rest in self.commands.rests}
        noisy = range(self.period) if self._motor_noise else ()
        self._segments = tuple(pairwise(sorted({0, self.period, *sampled, *applied, *noisy})))
        spaces: dict[str, Any] = dict(self.spaces[0].items())
        self.observation = {
            name: put(np.zeros((count, *space.shape))).to(torch.uint8 if space.dtype == np.uint8 else torch.float32)
            for name, space in spaces.items()
        }

    def starts(self, pose: str | None) -> InitialStates:
        """Return the starts of all bodies in a pose."""
        readers = {name: sense.reader for name, sense in self.senses.items() if sense.reader}
        return sample_initial_states(self._infants, self.body, self._most_starts, pose, readers, self.model, self.data)

    def seed(self, seeds: Mapping[int, int]) -> None:
        """Give new seeds to some worlds, which choose the same starts again, after the first."""
        self.chance.restart(seeds)
        self.ended.episode[list(seeds)] = 0

    def begin(self, starts: InitialStates, chosen: torch.Tensor) -> None:
        """Start an episode in the worlds that a start is chosen for, shape (worlds,); -1 is none."""
        starts.restore(chosen, self.model, self.data, self.task.memory)
        start, begins = chosen.clamp(min=0), chosen >= 0
        controls = self._worlds.ctrl[:, self._actuators]
        self.commands.fill(begins, controls)
        self.commands.arrived = where_worlds(begins, controls, self.commands.arrived)
        if self._motor_noise:
            self._motor_noise.begin(self.commands.arrived, begins)
        for name, sense in self.senses.items():
            sense.refill(starts.samples[name][start], begins)
        self.arousal.begin(begins)
        self.ended.steps.masked_fill_(begins, 0)

    def arouse(self, levels: Mapping[int, float]) -> None:
        """Give some worlds another arousal."""
        if levels:
            level = self.arousal.level.clone()
            level[list(levels)] = put(list(levels.values()))
            self.arousal.set(level)

    def step(self) -> None:
        """Make a control step of all worlds with `actions`, and begin new episodes as the mode says.

        It is cut wherever commands arrive, noise is drawn or a sense is sampled. On a GPU, the physics steps between
        two cuts are one graph; terms run between these graphs.
        """
        self.clock += 1
        controls = self._controls_of(self._worlds, self.actions) if self._controls_of else self.actions
        self.commands.send(self.clock, controls)
        for start, end in self._segments:
            self._command(start)
            self._physics(end - start)
            for sense in self.senses.values():
                sense.sample(self._worlds, self.clock, self.period - end)
        judgement = self.task.judge(self._worlds, self.model, self.actions)
        self.ended.judge(judgement, self._worlds, self.actions, self.default_starts, self.chance.seeds)
        if self._mode == AutoresetMode.SAME_STEP:
            self.observe()
            self.final = {name: array.clone() for name, array in self.observation.items()}
        if self._mode != AutoresetMode.DISABLED:
            self.begin(self.default_starts, self.ended.chosen)
        self.observe()

    def settle(self) -> None:
        """Count what did not fit in the last step, if that has not been done, and make more room where it was short.

        Raises:
            DeviceError: If commands were not finite, or the room is as large as it gets and many infants lost contacts.
        """
        if self.ended.report is None:
            return
        report, self.ended.report = self.ended.report.cpu().numpy(), None
        for name, bit in FLAGS.items():
            self.overflows[name] += int(report[COUNTS + bit])
        if report[NOT_FINITE]:
            raise DeviceError(f"the last actions of infant {report[NOT_FINITE] - 1} were not finite")
        is_larger = self._make_room(self.room.after(report))
        if report[OVERFLOWED] > RARE * self.room.worlds and not is_larger:
            infants, room = self.ended.overflowed.nonzero(), self.room.present
            raise DeviceError(
                f"contacts or constraints of {len(infants)} infants, such as {int(infants[0])}, did not fit in the last"
                f" step, and there is no more room than contacts={room.contacts} and constraints={room.constraints}: "
                "look at what holds these infants, or make the environment with more, or with fewer infants"
            )

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
        self.room.present, self._worlds = wanted, device_worlds(self.data)
        self._graphs = {}  # They have the places of the former arrays in memory.
        return True

    def observe(self) -> None:
        """Write what has arrived of all senses, and what the task adds."""
        for sense in self.senses.values():
            sense.arrive(self.clock, self.observation)
        for name in self.task.observed:
            self.observation[name].copy_(self.task.memory[name])

    def _command(self, index: int) -> None:
        """Set the controls of the physics steps that follow."""
        if self.chance.is_used:
            self.chance.steps += 1
        commands = self.commands.receive(self.clock, index)
        if self._motor_noise:
            commands = self._motor_noise(commands, self._timestep_s)
        self._worlds.ctrl.index_copy_(1, self._actuators, commands)

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

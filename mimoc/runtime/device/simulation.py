"""The worlds of all infants on a device: one control step of all of them, without a word to the CPU."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any
from weakref import WeakKeyDictionary

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.vector import AutoresetMode

from mimoc.base.units import ms_to_s, to_steps
from mimoc.runtime.arousal import FIELDS, MAX_AROUSAL, ToneInModels, tone_of
from mimoc.runtime.device.arrays import device_worlds, put, term_of_worlds, where_worlds
from mimoc.runtime.device.bodies import WorldsModel, batched_data, enlarged, place_fixed
from mimoc.runtime.device.capacity import COUNTS, FLAGS, NO_REWARD, NOT_FINITE, OVERFLOWED, RARE, Capacity, Room
from mimoc.runtime.device.episodes import (
    AS_BUILT,
    DeviceTask,
    EpisodeEnds,
    InitialStates,
    StartOptions,
    changed_fields,
    changed_rows,
    sample_initial_states,
)
from mimoc.runtime.device.signals import (
    CounterRandom,
    DeviceError,
    DeviceNoise,
    DeviceSense,
    DeviceSetup,
    line_of,
    noise_of,
    space_of,
)
from mimoc.runtime.device.states import HISTORY, PHYSICS, Path, Slot, attribute, in_place, kept_in, nested, write_to
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import IntArray
from mimoc.schema.senses import MOTOR


class Bound:
    """The senses, commands and tasks of all infants, with their delays and noise."""

    def __init__(self, setup: DeviceSetup, chance: CounterRandom):
        infants, first = setup.infants, setup.infants[0]
        self.infants, self.body = infants, setup.body  # The bodies, and which is in each world.
        self.task = DeviceTask(infants, setup.body)
        self.senses = {name: DeviceSense(name, setup, chance) for name in first.senses}
        self.spaces = [space_of(infant, self.senses, body) for body, infant in enumerate(infants)]  # Spaces by body.
        self.actuators = put(first.actuation.actuators)
        self.commands = line_of(MOTOR, setup, len(self.actuators), chance, [None] * len(infants))
        commands: list[Any] = [infant.actuation.command for infant in infants]
        self.controls_of: Any = commands[0] and term_of_worlds("commands", commands, setup.body)
        self.motor_noise = noise_of(MOTOR, infants, setup.body, chance)
        period = to_steps(first.manifest.step_ms, first.manifest.timestep_ms)
        sampled = {int(period - rest) for sense in self.senses.values() for rest in sense.line.rests}
        applied = {int(rest) for rest in self.commands.rests}
        noisy = range(period) if self.motor_noise else ()
        self.segments = tuple(pairwise(sorted({0, period, *sampled, *applied, *noisy})))
        """The physics steps between two of which nothing but physics happens."""

    @property
    def noises(self) -> dict[str, DeviceNoise]:
        """The noise of each signal that has any."""
        noises = {name: sense.noise for name, sense in self.senses.items()} | {MOTOR: self.motor_noise}
        return {name: noise for name, noise in noises.items() if noise}

    def slots(self, clock: torch.Tensor) -> dict[Path, Slot]:
        """Return the memory of tasks, and the signals on their way at a time."""
        lines = {name: sense.line for name, sense in self.senses.items()} | {MOTOR: self.commands}
        memory = {name: in_place(values) for name, values in self.task.memory.items()}
        sent = {name: line.slot(clock) for name, line in lines.items()}
        deviations = {name: Slot(partial(getattr, line, "deviations"), line.deviate) for name, line in lines.items()}
        noise = {name: attribute(noise, "state") for name, noise in self.noises.items()}
        return {
            **dict(nested(memory, "task")),
            **dict(nested(sent, *HISTORY)),
            **dict(nested(deviations, "signals", "deviations")),
            **dict(nested(noise, "signals", "noise")),
            ("signals", "commanded"): in_place(self.commands.arrived),
        }


NO_MEMORY = "Failed to allocate"  # Part of Warp's error when a device is out of memory.


@dataclass(frozen=True, slots=True)
class DeviceOptions:
    """What is asked of infants on a device; see `DeviceEnv`."""

    autoreset_mode: AutoresetMode
    max_episode_steps: int | None
    touch: str
    starts: int
    contacts: int | None
    constraints: int | None


class DeviceBatch:
    """All infants on the device: physics, signals, tasks and episodes."""

    def __init__(self, infants: Sequence[InfantEnv], body_of_world: IntArray, options: DeviceOptions):
        self._options, self._device = options, wp.get_device()
        manifest = infants[0].manifest
        models = [infant.model for infant in infants]
        count = len(body_of_world)
        self.period = to_steps(manifest.step_ms, manifest.timestep_ms)
        self._timestep_s = ms_to_s(manifest.timestep_ms)
        self._fields = WorldsModel(models, body_of_world, changed_fields(infants))
        self.model = self._fields.warp
        pairs = self.model.nxn_geom_pair_filtered.numpy()
        self.room = Room.at_first(infants, pairs, options.contacts, options.constraints, count)
        self.overflows = dict.fromkeys(FLAGS, 0)  # Control steps in which it was set, by flag.
        self.captures, self._graphs = self._device.is_cuda, dict[int, wp.Graph]()  # Graphs, by number of steps.
        present = self.room.present
        self.data = batched_data(models, body_of_world, present.contacts, present.constraints)
        self._worlds, self.clock = device_worlds(self.data), put(0)
        self.chance = CounterRandom(put(np.arange(count)))
        self._drawn = WeakKeyDictionary[InfantEnv, Any]()
        self.bound = self._bound(infants, body_of_world)  # What is sensed, commanded and judged now.
        self.arousal = self._aroused()
        self.ended = EpisodeEnds(infants, self.bound.body, options.max_episode_steps, options.autoreset_mode)
        self.actions = torch.zeros_like(self.bound.commands.arrived)  # Actions of this control step, shape (worlds, n).
        spaces: dict[str, Any] = dict(self.bound.spaces[0].items())
        self.observation = {
            name: put(np.zeros((count, *space.shape))).to(torch.uint8 if space.dtype == np.uint8 else torch.float32)
            for name, space in spaces.items()
        }
        self.default_starts = self.starts(AS_BUILT)

    def state(self) -> Any:
        """Return the present state of all worlds, whose fields are views."""
        return self._worlds

    def become(self, infants: Sequence[InfantEnv], body_of_world: IntArray, worlds: IntArray) -> None:
        """Put other bodies, as built, into some worlds; all else continues."""
        models = [infant.model for infant in infants]
        bodies, has_moved = self._fields.fit(models, changed_fields(infants))
        if has_moved:
            self._graphs = {}  # They have the places of the former arrays in memory.
        bound = self._bound(infants, body_of_world)
        kept = kept_in(self.slots())
        self.arousal.set(self.arousal.as_built)
        self._fields.write(bodies, worlds, body_of_world[worlds])
        place_fixed(self.data, models, worlds, body_of_world[worlds])
        self.bound = bound
        self.arousal = self._aroused()
        write_to(self.slots(), kept)
        self.ended.limit(infants, self.bound.body)
        self.default_starts = self.starts(AS_BUILT)

    def slots(self) -> dict[Path, Slot]:
        """Return all that the next steps of the worlds depend on."""
        data = {name: in_place(array) for name in PHYSICS if (array := wp.to_torch(getattr(self.data, name))).numel()}
        rows = {name: put(which) for name, which in changed_rows(self.bound.infants[0]).items()}
        model = {name: in_place(wp.to_torch(getattr(self.model, name)), which) for name, which in rows.items()}
        counted = {name: attribute(self.ended, name) for name in ("steps", "episode", "ended")}
        drawn = {"seed": attribute(self.chance, "seeds"), "steps": attribute(self.chance, "steps")}
        return {
            **dict(nested(data, "physics")),
            **dict(nested(model, "model")),
            **dict(nested(counted)),
            **dict(nested(drawn, "random")),
            **self.bound.slots(self.clock),
            ("arousal",): Slot(lambda: self.arousal.level, self.arousal.set),
        }

    def _bound(self, infants: Sequence[InfantEnv], body_of_world: IntArray) -> Bound:
        return Bound(DeviceSetup(infants, put(body_of_world), self.model, self._options.touch), self.chance)

    def _aroused(self) -> "DeviceArousal":
        return DeviceArousal(self.bound.infants, self.bound.body, self.model)

    def starts(self, options: StartOptions) -> InitialStates:
        """Return the starts of all bodies with some options."""
        readers = {name: sense.reader for name, sense in self.bound.senses.items() if sense.reader}
        infants, body, most = self.bound.infants, self.bound.body, self._options.starts
        return sample_initial_states(infants, body, most, options, readers, self.model, self.data, self._drawn)

    def seed(self, seeds: Mapping[int, int]) -> None:
        """Give new seeds to worlds, whose first episode is counted anew."""
        self.chance.restart(seeds)
        self.ended.episode[list(seeds)] = 0

    def begin(self, starts: InitialStates, chosen: torch.Tensor) -> None:
        """Begin an episode in worlds with the chosen starts, shape (worlds,); -1 is none."""
        starts.restore(chosen, self.model, self.data, self.bound.task.memory)
        start, begins = chosen.clamp(min=0), chosen >= 0
        self._worlds.cvel.masked_fill_(begins[:, None, None], 0.0)  # Welds read that of the step before.
        controls = self._worlds.ctrl[:, self.bound.actuators]
        self.bound.commands.fill(begins, controls)
        self.bound.commands.arrived = where_worlds(begins, controls, self.bound.commands.arrived)
        if self.bound.motor_noise:
            self.bound.motor_noise.begin(self.bound.commands.arrived, begins)
        for name, sense in self.bound.senses.items():
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
        controls = self.bound.controls_of(self._worlds, self.actions) if self.bound.controls_of else self.actions
        self.bound.commands.send(self.clock, controls)
        for sense in self.bound.senses.values():
            sense.line.advance(self.period)
        for start, end in self.bound.segments:
            self._command(start)
            self._physics(end - start)
            for sense in self.bound.senses.values():
                sense.sample(self._worlds, self.clock, self.period - end)
        judgement = self.bound.task.judge(self._worlds, self.model, self.actions)
        self.ended.judge(judgement, self._worlds, self.actions, self.default_starts, self.chance.seeds)
        if self._options.autoreset_mode == AutoresetMode.SAME_STEP:
            self.observe()
            self.final = {name: array.clone() for name, array in self.observation.items()}
        if self._options.autoreset_mode != AutoresetMode.DISABLED:
            self.begin(self.default_starts, self.ended.chosen)
        self.observe()

    def settle(self) -> None:
        """Read the report of the last step once: count overflows, and make more room where it was short."""
        if self.ended.report is None:
            return
        report, self.ended.report = self.ended.report.cpu().numpy(), None
        for name, bit in FLAGS.items():
            self.overflows[name] += int(report[COUNTS + bit])
        if report[NOT_FINITE]:
            raise DeviceError(f"the last actions of infant {report[NOT_FINITE] - 1} were not finite")
        if report[NO_REWARD]:
            task = self.bound.infants[0].task.class_name
            raise DeviceError(f"task {task}: the last reward of infant {report[NO_REWARD] - 1} was no finite number")
        is_larger = self._make_room(self.room.after(report))
        if report[OVERFLOWED] > RARE * self.room.worlds and not is_larger:
            infants = self.ended.overflowed.nonzero()
            room = self.room.present
            raise DeviceError(
                f"contacts or constraints of {len(infants)} infants, such as {int(infants[0])}, did not fit in the last"
                f" step, and there is no more room than contacts={room.contacts} and constraints={room.constraints}: "
                "look at what holds these infants, or make the environment with more, or with fewer infants"
            )

    def _make_room(self, wanted: Capacity) -> bool:
        """Enlarge the room if the device has the memory; return whether it grew."""
        if wanted == self.room.present:
            return False
        try:
            self.data = enlarged(self.data, self.bound.infants[0].model, wanted.contacts, wanted.constraints)
        except RuntimeError as error:
            if NO_MEMORY not in str(error):
                raise
            self.room.largest = self.room.present
            return False
        self.room.present, self._worlds = wanted, device_worlds(self.data)
        self._graphs = {}  # They have the places of the former arrays in memory.
        return True

    def observe(self) -> None:
        """Write what has arrived of all senses, and what the task observes."""
        for sense in self.bound.senses.values():
            sense.arrive(self.clock, self.observation)
        for name in self.bound.task.observed:
            self.observation[name].copy_(self.bound.task.memory[name])

    def _command(self, index: int) -> None:
        self.chance.steps += 1
        self.bound.commands.advance(1)
        commands = self.bound.commands.receive(self.clock, index)
        if self.bound.motor_noise:
            commands = self.bound.motor_noise(commands, self._timestep_s)
        self._worlds.ctrl.index_copy_(1, self.bound.actuators, commands)

    def _physics(self, steps: int) -> None:
        """Make physics steps; on a GPU, a graph of them is captured once the first ones have loaded all kernels."""
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


class DeviceArousal:
    """The arousal of all infants."""

    def __init__(self, infants: Sequence[InfantEnv], body: torch.Tensor, model: mjw.Model):
        tones = [tone_of(infant.manifest.actuation, infant.model) for infant in infants]
        fields = [wp.to_torch(getattr(model, name)) for name in FIELDS]
        which = body.tolist()
        self._tone = ToneInModels([tones[index] for index in which], fields, infants[0].model.jnt_qposadr, put)
        self.as_built = put([float(infants[index].manifest.actuation.arousal) for index in which])
        self.level = self.as_built.clone()  # Arousal in each world now, shape (worlds,).
        self._is_set = False

    def set(self, level: torch.Tensor) -> None:
        """Set the arousal of all worlds, shape (worlds,), clipped to 0 and 2."""
        self.level, self._is_set = level.clamp(0, MAX_AROUSAL), True
        self._tone.write(self.level - self.as_built)

    def begin(self, begins: torch.Tensor) -> None:
        """Reset the arousal of worlds that begin an episode, shape (worlds,), to that as built."""
        if self._is_set:
            self.set(torch.where(begins, self.as_built, self.level))

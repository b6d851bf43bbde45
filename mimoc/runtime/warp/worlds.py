"""The worlds of all infants on a device: one control step of all of them, without a word to the CPU."""

from collections.abc import Mapping, Sequence
from typing import Any

import mujoco_warp as mjw
import numpy as np
import warp as wp
from gymnasium.spaces import Box, Dict
from gymnasium.vector import AutoresetMode

from mimoc.bundle.model import in_subtrees
from mimoc.delays.spec import MOTOR
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp import ending
from mimoc.runtime.warp.arrays import put
from mimoc.runtime.warp.bodies import batched_data, batched_model
from mimoc.runtime.warp.capacity import Capacity, measured
from mimoc.runtime.warp.lines import Line, delay_steps
from mimoc.runtime.warp.starts import Starts, drawn, model_fields
from mimoc.runtime.warp.tasks import device_task
from mimoc.runtime.warp.tasks.task import Judged
from mimoc.runtime.warp.touch import feeling
from mimoc.runtime.warp.vectors import VectorReader
from mimoc.senses.sense import IntArray
from mimoc.units import to_steps

GOAL = "goal"


class Worlds:
    """Everything on the device, and what happens there; all arrays keep their place in memory."""

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
        self.capacity = self._capacity(room)
        capacity, models = self.capacity, [each.model for each in infants]
        self.data = batched_data(models, body_of_world, capacity.contacts, capacity.constraints)
        self.body = put(body_of_world, wp.int32)
        self.task, self.clock = device_task(infants, count), wp.zeros(1, dtype=int)
        self._open_signals(touch)
        self.ended = ending.Ending(infants, self.body, len(self.task.terms), max_steps)
        self.default_starts = self.starts(None)
        self.memory = wp.zeros((count, self.default_starts.memory.shape[1]), dtype=float)
        self._judged = Judged(
            self.body,
            self.commands.entering,
            self.memory,
            self.ended.terms,
            self.ended.success,
            self.ended.terminated,
        )

    def _open_signals(self, touch: str) -> None:
        """Find what is sensed and commanded, with its delays."""
        self._touch = feeling(touch, self._infants, self.body) if "touch" in self._infants[0].senses else None
        self._readers: dict[str, Any] = {
            name: self._touch if name == "touch" else VectorReader(name, self._infants, self.body)
            for name in self._infants[0].senses
            if name != "nothing"
        }
        self._columns = put(self._infants[0].actuation.actuators, wp.int32)
        self.commands = Line(self._delays(MOTOR), self.period, self.body)
        self.lines = {name: Line(self._delays(name), self.period, self.body) for name in self._readers}
        self.spaces = [self._spaces(infant) for infant in self._infants]
        self._bounds = {
            name: [put([getattr(space[name], bound) for space in self.spaces]) for bound in ("low", "high")]
            for name in self.lines
        }
        shapes: dict[str, Any] = {name: space.shape for name, space in self.spaces[0].items()}
        self.observation = {name: wp.zeros((self.body.shape[0], *shape), dtype=float) for name, shape in shapes.items()}
        self.final = {name: wp.zeros_like(array) for name, array in self.observation.items()}

    def starts(self, pose: str | None) -> Starts:
        """Return the starts of all bodies in a pose."""
        return drawn(self._infants, self._most_starts, pose, self.model, self.task, self._touch)

    def begin(self, starts: Starts, chosen: wp.array) -> None:
        """Start an episode in the worlds that a start is chosen for; -1 is none."""
        starts.restore(chosen, self.model, self.data, self.memory)
        self.commands.refill(chosen, starts.commands)
        for name, line in self.lines.items():
            line.refill(chosen, starts.samples[name])
        self.ended.begin(chosen)

    def step(self) -> None:
        """Make a control step of all worlds with `commands.entering`, and begin new episodes as the mode says."""
        wp.launch(_tick, 1, [], [self.clock])
        self.commands.send(self.clock, -1)
        for index in range(self.period):
            self.commands.apply(self.clock, index, self._columns, self.data.ctrl)
            mjw.step(self.model, self.data)
            self._sample(self.period - 1 - index)
        self.ended.clear()
        self.task.judge(self.model, self.data, self._judged)
        self.ended.judge(self.data, self.commands.entering, self._mode, self.default_starts)
        if self._mode == AutoresetMode.SAME_STEP:
            self.observe()
            for name, array in self.observation.items():
                wp.copy(self.final[name], array)
        if self._mode != AutoresetMode.DISABLED:
            self.begin(self.default_starts, self.ended.chosen)
        self.observe()

    def observe(self) -> None:
        """Write what has arrived of all senses, and what the task adds."""
        for name, line in self.lines.items():
            low, high = self._bounds[name]
            line.arrive(self.clock, low, high, self.observation[name])
        if self.task.goal:
            self.task.observe(self.memory, self.observation[GOAL])

    def _sample(self, rest: int) -> None:
        """Sample the senses of which something is sent now."""
        for name, line in self.lines.items():
            if (line.delays % self.period == rest).any():
                self._readers[name](self.model, self.data, line.entering)
                line.send(self.clock, rest)

    def _capacity(self, room: tuple[int | None, int | None]) -> Capacity:
        """Return the room for contacts and constraints, measured where nothing was said."""
        contacts, constraints = room
        if contacts and constraints:
            return Capacity(contacts, constraints)
        poses, pairs = [each.manifest.pose for each in self._infants], self.model.nxn_geom_pair_filtered.numpy()
        found = measured([each.model for each in self._infants], poses, pairs)
        return Capacity(contacts or found.contacts, constraints or found.constraints)

    def _delays(self, signal: str) -> IntArray:
        """Return the delays of a signal's numbers, of each body, shape (bodies, n)."""
        return np.stack([_delays_of(infant, signal, self._touch) for infant in self._infants])

    def _spaces(self, infant: InfantEnv) -> Dict:
        """Return what an infant observes here; it differs from the CPU where touch is told by bodies."""
        spaces: Mapping[str, Any] = infant.observation_space.spaces  # pyright: ignore[reportAttributeAccessIssue]
        found = dict(spaces)
        if self._touch is not None:
            low, high = (getattr(spaces["touch"], bound).flat[0] for bound in ("low", "high"))
            found["touch"] = Box(low, high, (len(self._touch.bodies),), np.float32)
        return Dict(found)


def _delays_of(infant: InfantEnv, signal: str, touch: Any) -> IntArray:
    """Return the delay of each number of a signal of an infant, shape (n,), in physics steps."""
    model, manifest = infant.model, infant.manifest
    in_legs = in_subtrees(model, [model.body(leg).id for leg in manifest.delays.legs])
    if signal == MOTOR:
        bodies = model.jnt_bodyid[model.actuator_trnid[infant.actuation.actuators, 0]]
        return delay_steps(manifest, signal, in_legs[bodies], len(bodies))
    sense: Any = infant.senses[signal]
    bodies = touch.bodies if signal == "touch" else sense.bodies
    count = len(touch.bodies) if signal == "touch" else len(sense.layout)
    return delay_steps(manifest, signal, None if bodies is None else in_legs[bodies], count)


@wp.kernel(enable_backward=False)
def _tick(clock: wp.array[int]):
    clock[0] = clock[0] + 1

"""The senses of all infants on a device: reading, noise, delay lines and observations."""

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import mujoco_warp as mjw
import numpy as np
import torch
import warp as wp
from gymnasium.spaces import Box, Dict

from mimoc.bundle.model import in_subtrees
from mimoc.delays.spec import MOTOR
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.arrays import put
from mimoc.runtime.warp.lines import Line, delay_steps
from mimoc.runtime.warp.noise import DeviceNoise
from mimoc.runtime.warp.touch import Feeling
from mimoc.senses.sense import IntArray
from mimoc.units import ms_to_s


class Channel(Protocol):
    """A sense of all infants."""

    def sample(self, model: mjw.Model, data: mjw.Data, clock: wp.array, rest: int) -> None:
        """Read what arrives *rest* physics steps less than whole control steps later, if anything does."""
        ...

    def arrive(self, clock: wp.array, observation: Mapping[str, wp.array]) -> None:
        """Write what has arrived to its arrays in the observation."""
        ...

    def refill(self, chosen: wp.array, samples: Mapping[str, wp.array]) -> None:
        """Forget what is on the way in worlds that begin with one of some starts, by what is sensed at these."""
        ...


class Numbers:
    """A sense that is one vector of numbers."""

    def __init__(
        self,
        name: str,
        infants: Sequence[InfantEnv],
        spaces: Sequence[Dict],
        body: wp.array,
        read: Any,
        noise: DeviceNoise | None,
    ):
        """Set up the delays.

        Args:
            name: Of the sense and of its array.
            infants: The different bodies.
            spaces: What each observes.
            body: Which body lives in each world, shape (worlds,).
            read: Writes what is sensed by a model and data to an array of shape (worlds, n).
            noise: What is added, if anything is.
        """
        self._name, self._read, self._noise, manifest = name, read, noise, infants[0].manifest
        self._timestep_s, self._period = ms_to_s(manifest.timestep_ms), round(manifest.step_ms / manifest.timestep_ms)
        touch = read if name == "touch" else None
        self.line = Line(np.stack([delays_of(infant, name, touch) for infant in infants]), self._period, body)
        self._bounds = [put([getattr(space[name], bound) for space in spaces]) for bound in ("low", "high")]
        self._rests = np.unique(self.line.delays % self._period)
        self._everyone = torch.arange(body.shape[0], dtype=torch.int32, device=wp.device_to_torch(body.device))

    def sample(self, model: mjw.Model, data: mjw.Data, clock: wp.array, rest: int) -> None:
        """Read it, if some of it is sent now."""
        if rest not in self._rests:
            return
        self._read(model, data, self.line.entering)
        if self._noise:
            earlier = min((other - rest) % self._period or self._period for other in self._rests)
            entering = wp.to_torch(self.line.entering)
            entering.copy_(self._noise(entering, float(earlier) * self._timestep_s))
        self.line.send(clock, rest)

    def arrive(self, clock: wp.array, observation: Mapping[str, wp.array]) -> None:
        """Write it within its bounds."""
        self.line.arrive(clock, *self._bounds, observation[self._name])

    def refill(self, chosen: wp.array, samples: Mapping[str, wp.array]) -> None:
        """Sense what the starts have, with noise that is drawn anew."""
        if self._noise:
            starts, begins = wp.to_torch(chosen).clamp(min=0).long(), wp.to_torch(chosen) >= 0
            noisy = self._noise.begin(wp.to_torch(samples[self._name])[starts], begins)
            self.line.refill(wp.from_torch(torch.where(begins, self._everyone, -1)), wp.from_torch(noisy))
        else:
            self.line.refill(chosen, samples[self._name])


def delays_of(infant: InfantEnv, signal: str, touch: Feeling | None = None) -> IntArray:
    """Return the delay of each number of a signal of an infant, shape (n,), in physics steps."""
    model, manifest = infant.model, infant.manifest
    in_legs = in_subtrees(model, [model.body(leg).id for leg in manifest.delays.legs])
    if signal == MOTOR:
        bodies = model.jnt_bodyid[model.actuator_trnid[infant.actuation.actuators, 0]]
        return delay_steps(manifest, signal, in_legs[bodies], len(bodies))
    sense: Any = infant.senses[signal]
    bodies = touch.bodies if touch else sense.bodies
    count = len(touch.bodies) if touch else len(sense.layout)
    return delay_steps(manifest, signal, None if bodies is None else in_legs[bodies], count)


def space_of(infant: InfantEnv, touch: Feeling | None) -> Dict:
    """Return what an infant observes here; it differs from the CPU where touch is told by bodies."""
    spaces: Mapping[str, Any] = infant.observation_space.spaces
    found = dict(spaces)
    if touch is not None:
        low, high = (getattr(spaces["touch"], bound).flat[0] for bound in ("low", "high"))
        found["touch"] = Box(low, high, (len(touch.bodies),), np.float32)
    return Dict(found)
